"""The README is the front door: every command in it runs."""

import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.daemons import Running
from tests.docs.test_quick_start import INSTALLED
from utility_specs import load_specs

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()
BAG = "sendworthy import "
"""The commands on a bag begin so; `tests/studies/replay/test_replaying.py` runs them."""

START = (" && ".join(map(str.strip, INSTALLED)), "venv/bin/sendworthy run --robot r1 --mode shadow")
"""How a daemon is installed, which the test of the quick start does, too, and started."""


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def commands():
    lines = [line.split("#")[0].strip() for block in blocks("sh") for line in block.splitlines()]
    return [line for line in lines if line]


def test_all_commands_are_known_here():
    """A command that is added to the README is added to a test: of targets, of the start, or of bags."""
    tried = [line for block in blocks("sh") if block.startswith(BAG) for line in block.splitlines()]
    for command in commands():
        known = command in START or any(line.startswith(command) for line in tried)
        assert known or command.startswith("make "), command


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


def test_the_daemon_starts_as_it_says():
    """Without specs everything passes."""
    daemon = Running(*shlex.split(START[1])[2:])
    try:
        daemon.wait_for("no specs in specs.d: everything passes")
        assert daemon.status()["mode"] == "shadow"
    finally:
        daemon.end()
