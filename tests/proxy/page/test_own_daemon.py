"""The page with a daemon of its own."""

import json
import signal

import pytest

from tests.daemons import Running
from tests.pages import SPECS, Camera, Served
from tests.ports import free_port


@pytest.mark.full
def test_a_page_joins_the_mesh_by_itself(stack, tmp_path):
    """It sees a robot's images, obeys what it orders, takes up files that change, and ends in order."""
    mesh, app = (f"tcp/127.0.0.1:{free_port()}" for _ in range(2))
    for name in ("r1", "ground"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "camera.toml").write_text(SPECS.format(limit="1 Mbit/s"))
    config = tmp_path / "ground.toml"
    config.write_text(
        f'robot = "ground"\n[app]\nlisten = ["{app}"]\n[mesh]\nlisten = ["{mesh}"]\nscouting = false\n'
        f'[specs]\npath = "{tmp_path}/ground"\n[fleet]\nmode = true\n'
    )
    page = Served("--config", str(config))
    stack.callback(page.end)
    robot = Running("--robot", "r1", "--specs.path", str(tmp_path / "r1"), "--mesh.connect", f'["{mesh}"]')
    stack.callback(robot.end)
    robot.wait_for("sendworthy ")
    camera = Camera("r1", robot.endpoint, 10)
    stack.callback(camera.close)
    live = page.live()
    stack.callback(live.close)
    live.until(lambda head, _: head["kind"] == "frame")
    _, answer = page.told("/filter", {"filter": "shadow"})
    assert {each["robot"]: each["obeyed"] for each in answer["outcomes"]} == {"ground": True, "r1": False}
    before = json.loads(page.ask("GET", "/specs")[2])["generation"]
    (tmp_path / "ground" / "camera.toml").write_text(SPECS.format(limit="2 Mbit/s"))
    live.until(lambda head, _: head.get("specs") not in (before, None))
    assert page.end(signal.SIGTERM) == 0
