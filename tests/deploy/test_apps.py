"""What keeps unmodified applications at their daemon; whether it does is tested on hosts, in tests/system."""

import json
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest
import zenoh

APPS = Path(__file__).parent.parent.parent / "deploy" / "apps"


def variables(file):
    """Read a file as systemd's EnvironmentFile does."""
    lines = [line for line in file.read_text().splitlines() if line and not line.startswith("#")]
    pairs = [line.partition("=")[::2] for line in lines]
    return {name: "".join(shlex.split(text)) for name, text in pairs}


def test_every_file_is_in_the_manual():
    """The table says for which application each is."""
    manual = (APPS.parents[1] / "docs" / "guides" / "applications.md").read_text()
    assert [file.name for file in APPS.iterdir() if f"(../../deploy/apps/{file.name})" not in manual] == []


def test_the_environment_names_the_configuration_file_and_what_ros_overrides(monkeypatch):
    """Zenoh takes both, read by systemd or by a shell."""
    file = APPS / "zenoh.env"
    environ = variables(file)
    shell = subprocess.run(["sh", "-c", f"set -a; . {file}; env"], capture_output=True, text=True, check=True, env={})
    assert {f"{name}={text}" for name, text in environ.items()} <= set(shell.stdout.splitlines())
    monkeypatch.setenv("ZENOH_CONFIG", str(APPS / Path(environ["ZENOH_CONFIG"]).name))
    assert json.loads(zenoh.Config.from_env().get_json("mode")) == "client"
    config = zenoh.Config()
    for override in environ["ZENOH_CONFIG_OVERRIDE"].split(";"):
        config.insert_json5(*override.split("=", 1))
    assert json.loads(config.get_json("connect/endpoints")) == ["tcp/localhost:7447"]
    assert not json.loads(config.get_json("scouting/multicast/enabled"))


@pytest.mark.parametrize(("name", "listens"), [("client.json5", None), ("peer.json5", ["tcp/127.0.0.1:0"])])
def test_configuration_files_scout_for_nobody_and_never_give_up(name, listens):
    """They know localhost, and nothing else."""
    config = zenoh.Config.from_file(str(APPS / name))
    assert json.loads(config.get_json("connect/endpoints")) == ["tcp/127.0.0.1:7447"]
    assert json.loads(config.get_json("connect/timeout_ms")) == -1
    assert json.loads(config.get_json("connect/retry"))["period_max_ms"] == 200
    assert not json.loads(config.get_json("scouting/multicast/enabled"))
    assert listens is None or json.loads(config.get_json("listen/endpoints")) == listens


def test_systemd_takes_the_units(tmp_path):
    """The namespace, and an application that is put into it."""
    if shutil.which("systemd-analyze") is None:
        pytest.skip("needs systemd-analyze")
    shutil.copy(APPS / "sendworthy-apps.service", tmp_path)
    (tmp_path / "camera.service").write_text("[Service]\nExecStart=/bin/true\n")
    (tmp_path / "camera.service.d").mkdir()
    shutil.copy(APPS / "namespace.conf", tmp_path / "camera.service.d")
    verify = ["systemd-analyze", "verify", "sendworthy-apps.service", "camera.service"]
    found = subprocess.run(
        verify,
        cwd=tmp_path,
        env={"SYSTEMD_UNIT_PATH": f"{tmp_path}:", "PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (found.returncode, found.stderr) == (0, "")
