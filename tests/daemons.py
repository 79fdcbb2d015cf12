"""Daemons as processes of their own, as an operator starts them."""

import os
import signal
import subprocess
import sys
import threading
from contextlib import contextmanager, suppress
from pathlib import Path

from proxy.commands.client import NoAnswerError, connected
from proxy.status.model import Status
from tests.ports import free_port
from tests.waiting import wait_until

ROOT = Path(__file__).parent.parent


class Running:
    """A daemon process of a `program` of Python. `endpoint` is its application side, `lines` what it logged so far."""

    def __init__(self, *arguments, endpoint=None, program=("-m", "proxy.cli"), **environ):
        self.endpoint = endpoint or f"tcp/127.0.0.1:{free_port()}"
        command = [
            *(sys.executable, *program, "run"),
            *("--app.listen", f'["{self.endpoint}"]'),
            *("--mesh.listen", "[]", "--mesh.scouting", "false"),
            *arguments,
        ]
        self.process = subprocess.Popen(command, cwd=ROOT, env=os.environ | environ, stderr=subprocess.PIPE, text=True)
        self.lines = []

    def wait_for(self, text):
        """Read the log up to a line that holds `text`; return the line. A daemon that never says it is killed."""
        patience = threading.Timer(60.0, self.process.kill)
        patience.start()
        try:
            for line in self.process.stderr:
                self.lines.append(line)
                if text in line:
                    return line
        finally:
            patience.cancel()
        raise AssertionError(f'no "{text}" in the log:\n{"".join(self.lines)}')

    def status(self):
        """What the daemon says of itself, as soon as it answers: a busy machine may need longer than operators wait."""
        found = []

        def answered():
            with suppress(NoAnswerError), connected(self.endpoint) as client:
                found.extend(client.status(None))
            return found

        wait_until(answered, what="an answer of the daemon")
        (status,) = found
        Status.model_validate(status)
        return status

    @contextmanager
    def paused(self):
        """Stop the daemon for a while: it finds all that is done meanwhile as if it had been done at once."""
        self.process.send_signal(signal.SIGSTOP)
        os.waitpid(self.process.pid, os.WUNTRACED)
        try:
            yield
        finally:
            self.process.send_signal(signal.SIGCONT)

    def end(self, number=signal.SIGTERM):
        """Ask the daemon to stop; return its exit code."""
        if self.process.poll() is None:
            self.process.send_signal(number)
        try:
            self.lines += self.process.communicate(timeout=30)[1].splitlines(keepends=True)
        finally:
            self.process.kill()
        return self.process.returncode


def specs_file(folder):
    """Write a small set of specs."""
    file = folder / "camera.toml"
    file.write_text(
        '[[constraint]]\nkind = "throughput"\nlimit = "2 Mbit/s"\nwindow = 0.5\n'
        '[[information_type]]\nname = "camera"\nkeys = ["robot/*/camera"]\naggregation = "most_recent"\n'
        'weight = 1.0\nutility = { kind = "video" }\n'
    )
    return file
