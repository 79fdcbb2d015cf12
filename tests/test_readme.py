"""The README is the front door: every command in it runs."""

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from tests.daemons import Running
from utility_specs import load_specs

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def commands():
    lines = [line.split("#")[0].strip() for block in blocks("sh") for line in block.splitlines()]
    return [line for line in lines if line]


def test_all_commands_are_known_here():
    """A command that is added to the README is added to a test."""
    tested = ("make ", "python3 -m venv", "/opt/sendworthy/bin/pip install .", "/opt/sendworthy/bin/sendworthy run")
    for command in commands():
        assert command.startswith((*tested, "sendworthy ")), command


@pytest.mark.parametrize("command", [line for line in commands() if line.startswith("make ")])
def test_make_knows_the_targets(command):
    """Each `make` command of the README names a target; what `demo` runs is tested with the demo."""
    assert shutil.which("make")
    subprocess.run([*shlex.split(command), "--dry-run"], cwd=ROOT, check=True, capture_output=True)


def test_the_spec_in_it_loads(tmp_path):
    """The example is a spec as it stands, and the ready-made one it names says the same."""
    (spec,) = blocks("toml")
    (tmp_path / "camera.toml").write_text(spec)
    assert [kind.name for kind in load_specs(tmp_path).types] == ["camera"]
    assert [kind.name for kind in load_specs(ROOT / "utility_specs" / "surveillance.toml").types] == ["camera"]


def test_the_daemon_runs_and_answers_as_it_says(tmp_path):
    """`run` with the sample configuration, then `check`, `explain`, `status` and `mode shadow`."""
    specs = tmp_path / "specs.d"
    specs.mkdir()
    shutil.copy(ROOT / "utility_specs" / "surveillance.toml", specs)
    config = shutil.copy(ROOT / "deploy" / "sendworthy.toml", tmp_path)
    (tmp_path / "image.jpg").write_bytes(cv2.imencode(".jpg", np.zeros((48, 64, 3), np.uint8))[1].tobytes())
    daemon = Running("--config", str(config), "--robot", "r1", "--planner.iterations", "500")
    try:
        daemon.wait_for("robot r1")
        for line in [line for line in commands() if line.startswith("sendworthy ")]:
            words = shlex.split(line)[1:]
            if words[0] == "learn":
                continue  # needs samples: tests/proxy/commands/test_learn.py
            where = [] if words[0] == "check" else ["--connect", daemon.endpoint]
            run = [sys.executable, "-m", "proxy.cli", *words, *where]
            done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False, env=environment())
            assert done.returncode == 0, done.stderr
            assert done.stdout
    finally:
        assert daemon.end() == 0


def environment():
    return {"PYTHONPATH": str(ROOT), "PATH": "/usr/bin:/bin"}
