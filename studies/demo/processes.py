"""The demo's processes: started on a leash, heard when ready, ended together however the demo ends."""

import json
import os
import selectors
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self


class DemoError(Exception):
    """The demo cannot go on; says what to look at."""


def entering(namespace: str | None) -> list[str]:
    """Return what a command in a network namespace begins with."""
    if namespace is None:
        return []
    return [shutil.which("ip", path="/usr/sbin:/sbin:/usr/bin:/bin") or "ip", "netns", "exec", namespace]


class Process:
    """A running process; what it writes to standard error goes to a file."""

    def __init__(self, name: str, command: Sequence[str], errors: Path, within: str | None = None) -> None:
        self.name = name
        self._errors = errors
        self._saying = threading.Lock()
        leash = [sys.executable, "-m", "studies.demo.leash", str(os.getpid())]
        with errors.open("wb") as file:
            self._popen = subprocess.Popen(
                [*leash, *entering(within), sys.executable, *command],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=file,
                start_new_session=True,  # Ctrl-C is for the demo, which then ends its processes in order
            )

    @property
    def pid(self) -> int:
        """Its process id."""
        return self._popen.pid

    def hear(self, timeout: float) -> dict[str, Any]:
        """Wait for the next line of JSON that it says. Raises DemoError when none comes in time [s]."""
        assert self._popen.stdout is not None  # noqa: S101  # for the type checker
        with selectors.DefaultSelector() as selector:
            selector.register(self._popen.stdout, selectors.EVENT_READ)
            line = self._popen.stdout.readline() if selector.select(timeout) else b""
        if not line:
            raise DemoError(f"{self.name} did not get ready within {timeout:.0f} s: {self.last_words()}")
        facts: dict[str, Any] = json.loads(line)
        return facts

    def tell(self, message: Any) -> None:
        """Say a line of JSON to it; any thread may."""
        assert self._popen.stdin is not None  # noqa: S101  # for the type checker
        with self._saying:
            self._popen.stdin.write(json.dumps(message).encode() + b"\n")
            self._popen.stdin.flush()

    def check(self) -> None:
        """Raise DemoError when it has ended."""
        if self._popen.poll() is not None:
            raise DemoError(f"{self.name} ended with code {self._popen.returncode}: {self.last_words()}")

    def last_words(self) -> str:
        """Return the end of what it wrote to standard error."""
        return " | ".join(self.errors()[-3:]) or "it said nothing"

    def errors(self) -> list[str]:
        """Return the lines that it wrote to standard error."""
        return self._errors.read_text(errors="replace").strip().splitlines()

    def terminate(self) -> None:
        """Ask it to stop."""
        self._popen.terminate()

    def reap(self, timeout: float) -> None:
        """Wait until it has stopped; kill it when that takes longer than `timeout` [s]."""
        try:
            self._popen.wait(timeout)
        except subprocess.TimeoutExpired:
            self._popen.kill()
            self._popen.wait()
        for pipe in (self._popen.stdin, self._popen.stdout):
            if pipe is not None:
                pipe.close()


class Troupe:
    """All processes of a run. Leaving it ends them, those started last first."""

    def __init__(self, folder: Path, patience: float = 5.0) -> None:
        self._folder = folder
        self._patience = patience
        """How long a process may take to stop [s]."""
        self.processes: list[Process] = []

    def start(self, name: str, *command: str, within: str | None = None) -> Process:
        """Start `python COMMAND…`, in a network namespace where one is named."""
        process = Process(name, command, self._folder / f"{name}.err", within)
        self.processes.append(process)
        return process

    def check(self) -> None:
        """Raise DemoError when any has ended."""
        for process in self.processes:
            process.check()

    def end(self, processes: Sequence[Process]) -> None:
        """End these and wait until they have ended."""
        for process in processes:
            process.terminate()
        deadline = time.monotonic() + self._patience
        for process in processes:
            process.reap(max(0.1, deadline - time.monotonic()))
            self.processes.remove(process)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end(list(reversed(self.processes)))
