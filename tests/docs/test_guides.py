"""What the guides tell to type, beside real daemons."""

import json
import sys
from contextlib import ExitStack

import pytest

from tests.daemons import Running, specs_file
from tests.docs.pages import ROOT, blocks, commands
from tests.docs.terminal import Terminal
from tests.ports import free_port
from tests.waiting import wait_until

GUIDES = ROOT / "docs" / "guides"
FLEETS = GUIDES / "fleets.md"
CONFIGURATION = ROOT / "docs" / "reference" / "configuration.md"
RASPBERRY_PI = GUIDES / "raspberry-pi.md"
TYPED = {
    *commands(FLEETS),
    *commands(CONFIGURATION),
    "sendworthy --version",
    "sendworthy status",
}
"""What is run here."""
WITH_ROOT = set(commands(RASPBERRY_PI))
"""What `tests/system/test_manual.py` runs, as far as it installs nothing and has no radio: the rest stands below."""
ELSEWHERE = {
    "sudo apt install ./sendworthy_VERSION_arm64.deb": "the tests of the package install it",
    "export RMW_IMPLEMENTATION=rmw_zenoh_cpp": "tests/system/test_ros2.py has what nodes put on the wire",
    "ros2 run demo_nodes_cpp talker": "likewise: there is no ROS 2 for the machines of the tests",
}
RUN = TYPED | WITH_ROOT | set(ELSEWHERE)
HERE = """
sendworthy() {{
    case $1 in
    check | config | import | replay | --version) {program} "$@" ;;
    *) {program} "$@" --connect {app} ;;
    esac
}}
"""
CSV = "t_gen,robot,key,size\n" + "".join(f"{number / 10},r1,robot/r1/camera,40000\n" for number in range(30))


def typed(name, lines, folder, endpoint):
    """Type lines in a folder; return what was printed. Fails at the first command that does."""
    program = f"{sys.executable} -m proxy.cli"
    shell = Terminal(name, HERE.format(program=program, app=endpoint) + "\n".join(lines), folder, PYTHONPATH=str(ROOT))
    try:
        return shell.wait()
    finally:
        shell.close()


@pytest.fixture
def fleet(tmp_path):
    """Two robots that obey, as the page configures them: the folder of the operator, and the daemon there."""
    (table,) = blocks(FLEETS, "toml")
    mesh = f"tcp/127.0.0.1:{free_port()}"
    with ExitStack() as closing:
        daemons = []
        for name in ("r1", "r2"):
            folder = tmp_path / name
            folder.mkdir()
            file = folder / "sendworthy.toml"
            file.write_text(table.replace("/var/lib/sendworthy/specs.d", str(folder / "specs.d")))
            side = ("--mesh.listen", json.dumps([mesh])) if name == "r1" else ("--mesh.connect", json.dumps([mesh]))
            daemons.append(Running("--config", str(file), "--robot", name, *side))
            closing.callback(daemons[-1].end)
        for daemon in daemons:
            wait_until(lambda daemon=daemon: daemon.status()["peers"], what="the robots to meet")
        operator = tmp_path / "operator"
        (operator / "specs.d").mkdir(parents=True)
        specs_file(operator / "specs.d")
        yield operator, daemons


@pytest.mark.full
def test_the_guide_to_fleets(fleet):
    """All robots take the specs, and then the mode; each says so."""
    folder, daemons = fleet
    text = typed("fleets", blocks(FLEETS, "sh")[0].splitlines(), folder, daemons[0].endpoint)
    assert "r1: mode shadow" in text
    assert "r2: mode shadow" in text
    for daemon in daemons:
        wait_until(lambda daemon=daemon: daemon.status()["mode"] == "shadow", what="the mode")
        assert daemon.status()["specs"] != ""


@pytest.mark.full
def test_a_change_is_tried_on_a_recording(tmp_path):
    """Traffic that was imported stands for what a robot recorded."""
    specs_file(tmp_path).rename(tmp_path / "new.toml")
    (tmp_path / "traffic.csv").write_text(CSV)
    (tmp_path / "recordings").mkdir()
    imported = "sendworthy import traffic.csv -o recordings/r1.mcap"
    typed("replay", [imported, *blocks(FLEETS, "sh")[1].splitlines()], tmp_path, "")
    assert "<svg" in (tmp_path / "difference.html").read_text()


def test_the_reference_of_the_configuration(tmp_path):
    """Where each value is from, and that there is no mistake."""
    specs_file(tmp_path)
    file = tmp_path / "sendworthy.toml"
    file.write_text('robot = "r1"\nspecs.path = "camera.toml"\n')
    shown, checked = (line.replace("/etc/sendworthy", str(tmp_path)) for line in commands(CONFIGURATION))
    lines = ["export SENDWORTHY_PLANNER__ITERATIONS=500", f"{shown} --config {file}", checked]
    text = typed("configuration", lines, tmp_path, "")
    assert "SENDWORTHY_PLANNER__ITERATIONS" in text


@pytest.mark.full
def test_what_is_asked_after_an_upgrade(tmp_path):
    """Which version runs."""
    daemon = Running("--robot", "r1", "--specs.path", str(specs_file(tmp_path)))
    try:
        daemon.wait_for("sendworthy ")
        text = typed("upgrade", ["sendworthy --version", "sendworthy status"], tmp_path, daemon.endpoint)
    finally:
        daemon.end()
    version = text.split()[1]
    assert f"robot r1   mode enforce   sendworthy {version}" in text
