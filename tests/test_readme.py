"""The README is the front door: every command in it runs."""

import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from contextlib import ExitStack, suppress
from pathlib import Path

import pytest

from tests.ports import free_port
from tests.waiting import wait_until
from utility_specs import load_specs

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text()
BAG = "sendworthy import "
"""The commands on a bag begin so; `tests/studies/replay/test_replaying.py` runs them."""


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def commands():
    lines = [line.split("#")[0].strip() for block in blocks("sh") for line in block.splitlines()]
    return [line for line in lines if line]


def test_all_commands_are_known_here():
    """A command that is added to the README is added to a test: of targets, of the tutorial, or of bags."""
    tried = [line for block in tutorial() for line in block.splitlines()]
    tried += [line for block in blocks("sh") if block.startswith(BAG) for line in block.splitlines()]
    for command in commands():
        assert command.startswith("make ") or any(line.startswith(command) for line in tried), command


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


def tutorial():
    """What is typed in the first, the second and the third terminal."""
    return [block for block in blocks("sh") if not block.startswith(("make ", BAG))]


HERE = """
sendworthy() {{
    case $1 in
    run) exec {program} "$@" --app.listen '["{app}"]' --mesh.listen '[]' --mesh.scouting false ;;
    check) {program} "$@" ;;
    learn) {program} "$@" --connect {app} --seconds 3 ;;
    *) {program} "$@" --connect {app} ;;
    esac
}}
"""
"""Goes behind `activate`: ports of our own, and a shorter while to listen."""
INSTALLED = ("python3 -m venv venv\n", "venv/bin/pip install .\n")


class Terminal:
    """A shell in which a block of the tutorial runs; what it prints is in `output`."""

    def __init__(self, name, block, cwd, environ):
        self.output = cwd / f"{name}.txt"
        with self.output.open("w") as output:
            self._process = subprocess.Popen(
                ["bash", "-e"],
                cwd=cwd,
                env=environ,
                stdin=subprocess.PIPE,
                stdout=output,
                stderr=subprocess.STDOUT,
                text=True,
                start_new_session=True,
            )
        self._process.stdin.write(block)
        self._process.stdin.close()

    def says(self, text):
        assert self._process.poll() in (None, 0), self.output.read_text()
        return text in self.output.read_text()

    def wait(self):
        """Wait until all of it has run; it ends at the first command that fails."""
        assert self._process.wait(120) == 0, self.output.read_text()
        return self.output.read_text()

    def close(self):
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGTERM)
        self._process.wait(30)


def place(folder, endpoint):
    """What the tutorial takes from the repository, with ports of our own."""
    shutil.copytree(ROOT / "deploy", folder / "deploy")
    client = folder / "deploy" / "apps" / "client.json5"
    client.write_text(client.read_text().replace("tcp/127.0.0.1:7447", endpoint))


def tried(folder, closing):
    """Do what the tutorial says, from making the folder on, where `venv` is there; return what was printed last."""
    first, second, third = tutorial()
    for line in INSTALLED:
        assert line in first
        first = first.replace(line, "")
    environ = {"PATH": "/usr/local/bin:/usr/bin:/bin", "HOME": str(folder), "PYTHONUNBUFFERED": "1"}
    robot = folder / "robot"
    daemon = Terminal("first", first, folder, environ)
    closing.callback(daemon.close)
    wait_until(lambda: daemon.says("no specs in specs.d: everything passes"), what="the start of the daemon")
    (application,) = blocks("python")
    (robot / "app.py").write_text(application)
    closing.callback(Terminal("second", second, robot, environ).close)
    shown = Terminal("third", third, robot, environ)
    closing.callback(shown.close)
    text = shown.wait()
    wait_until(lambda: daemon.says("files changed: specs "), what="the daemon to take up what was learned")
    assert (robot / "specs.d" / "learned.toml").exists()
    return text


def test_the_tutorial_works_from_top_to_bottom(tmp_path):
    """Every line of it, in three terminals; what is learned is what the daemon reads."""
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    place(tmp_path, endpoint)
    activate = tmp_path / "venv" / "bin" / "activate"
    activate.parent.mkdir(parents=True)
    scripts = Path(sys.executable).parent
    own = HERE.format(program=f"{sys.executable} -m proxy.cli", app=endpoint)
    activate.write_text(f"export PATH={scripts}:$PATH PYTHONPATH={ROOT}\n{own}")
    with ExitStack() as closing:
        text = tried(tmp_path, closing)
    assert 'information_type "battery": robot/*/battery' in text
    assert "robot r1   mode shadow   sendworthy " in text
    assert text.endswith("r1: enforce\n")


@pytest.mark.full
def test_the_tutorial_begins_with_an_installation_that_works(tmp_path):
    """In a virtual environment of its own, built from the sources, with the dependencies that it says it has."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    for name in filter(None, listed.split("\0")):
        target = tmp_path / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, target)
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    shutil.rmtree(tmp_path / "deploy")
    place(tmp_path, endpoint)
    subprocess.run(["bash", "-ec", "".join(INSTALLED)], cwd=tmp_path, check=True, capture_output=True)
    with (tmp_path / "venv" / "bin" / "activate").open("a") as activate:
        activate.write(HERE.format(program=tmp_path / "venv" / "bin" / "sendworthy", app=endpoint))
    with ExitStack() as closing:
        assert tried(tmp_path, closing).endswith("r1: enforce\n")
