"""What other programs make of what Sendworthy writes for them: promtool, and an interactive zsh."""

import os
import pty
import select
import shutil
import signal
import subprocess
from pathlib import Path

import pytest

from proxy.cli import main
from proxy.metrics.exposition import Exposition
from tests.proxy.metrics.statuses import status

pytestmark = pytest.mark.system

PATIENCE = 30.0
"""A shell says nothing for so long only when it has nothing more to say [s]."""


def test_prometheus_finds_nothing_to_complain_of():
    """Names, units, types and help texts are as its own checker wants them."""
    promtool = shutil.which("promtool", path=f"{Path('.venv/bin').resolve()}:{os.environ['PATH']}")
    assert promtool, "tests/system/run installs it"
    text = Exposition(status).text()
    checked = subprocess.run([promtool, "check", "metrics"], input=text, capture_output=True, check=False)
    assert (checked.returncode, checked.stdout + checked.stderr) == (0, b"")


class Zsh:
    """An interactive shell on a terminal of its own, while in a `with` statement."""

    def __init__(self, folder):
        self._folder = folder

    def __enter__(self):
        self._pid, self._terminal = pty.fork()
        if not self._pid:
            os.chdir(self._folder)
            os.execvpe("zsh", ["zsh", "-f", "-i"], {**os.environ, "TERM": "dumb", "HOME": self._folder})  # noqa: S606
        return self

    def __exit__(self, *_):
        os.kill(self._pid, signal.SIGKILL)
        os.waitpid(self._pid, 0)
        os.close(self._terminal)

    def type(self, keys, until):
        """Press keys; return what the shell has said when that is among it."""
        os.write(self._terminal, keys.encode())
        said = ""
        while until not in said:
            assert select.select([self._terminal], [], [], PATIENCE)[0], said
            said += os.read(self._terminal, 65536).decode(errors="replace").replace("\r", "").replace("\a", "")
        return said


@pytest.mark.parametrize(
    ("typed", "completed"),
    [
        ("sendworthy sta", "sendworthy status "),
        ("sendworthy mode enf", "sendworthy mode enforce "),
        ("sendworthy replay --no-b", "sendworthy replay --no-bound "),
        ("sendworthy replay r.mc", "sendworthy replay r.mcap "),
    ],
)
def test_zsh_completes(tmp_path, capsys, typed, completed):
    """Commands, their words, flags and files, where the script is on `fpath`."""
    assert main(["completion", "zsh"]) == 0
    (tmp_path / "_sendworthy").write_text(capsys.readouterr().out)
    (tmp_path / "r.mcap").touch()
    with Zsh(str(tmp_path)) as shell:
        shell.type("fpath=($PWD $fpath); autoload -Uz compinit; compinit -u -D; print READ''Y\n", until="READY")
        assert completed in shell.type(f"{typed}\t", until=completed)
