"""Shells in which what a page says is typed, beside a daemon with ports of its own."""

import os
import signal
import subprocess
from contextlib import suppress

ENVIRON = {"PATH": "/usr/local/bin:/usr/bin:/bin", "PYTHONUNBUFFERED": "1"}


class Terminal:
    """A shell that runs a block; what it prints is in `output`."""

    def __init__(self, name, block, cwd, **environ):
        self.output = cwd / f"{name}.txt"
        with self.output.open("w") as output:
            self._process = subprocess.Popen(
                ["bash", "-e"],
                cwd=cwd,
                env=ENVIRON | {"HOME": str(cwd)} | environ,
                stdin=subprocess.PIPE,
                stdout=output,
                stderr=subprocess.STDOUT,
                text=True,
                start_new_session=True,
            )
        self._process.stdin.write(block)
        self._process.stdin.close()

    def says(self, text):
        """Whether it has printed that; fails when a command of it has."""
        assert self._process.poll() in (None, 0), self.output.read_text()
        return text in self.output.read_text()

    def wait(self):
        """Wait until all of it has run, and return what it printed; it ends at the first command that fails."""
        assert self._process.wait(120) == 0, self.output.read_text()
        return self.output.read_text()

    def close(self):
        """End it and all that it started."""
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGTERM)
        self._process.wait(30)
