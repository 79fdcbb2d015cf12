"""The kernel gives a daemon no more memory than it has."""

import os
import subprocess
from contextlib import suppress

import pytest

from tests.faults.scene import Fault
from tests.waiting import wait_until

pytestmark = pytest.mark.system
MORE, LEAST_MORE = 1 << 20, 1 << 16
"""What a daemon may take beyond that, its files in memory included, at first and at least [B]."""


class Tight(Fault):
    """The daemon in a group may hold little more than it does: for more the kernel takes something else from it."""

    def __init__(self, group):
        self._group = group

    def start(self):
        self._limit, self._more = 1 << 62, MORE
        wait_until(self._pressed, 60.0, "the limit to be hit")

    def _pressed(self):
        """Let it have little more than the least that it was seen to hold, ever less; whether it has asked for more."""
        least = int((self._group / "memory.usage_in_bytes").read_text()) + self._more
        self._more = max(LEAST_MORE, self._more * 9 // 10)
        if least < self._limit:
            self._limit = least
            with suppress(OSError):  # it holds more by now, of which nothing can be taken
                (self._group / "memory.limit_in_bytes").write_text(str(least))
        return self.hits() > 0

    def hits(self):
        """How often it asked for more."""
        return int((self._group / "memory.failcnt").read_text())

    def stop(self):
        (self._group / "memory.limit_in_bytes").write_text("-1")


GROUPED = """
import sys
with open({procs!r}, "w") as group:
    group.write("0")
from proxy.cli import main
sys.exit(main())
"""
"""A daemon that puts itself into a group."""


@pytest.fixture
def group(tmp_path, stack):
    """A group of processes for which the kernel counts memory; it goes after the processes in it."""
    folder = tmp_path / "groups"
    folder.mkdir()
    if subprocess.run(["mount", "-t", "cgroup", "-o", "memory", "cgroup", str(folder)], check=False).returncode:
        pytest.skip("this kernel counts memory in another way")
    stack.callback(subprocess.run, ["umount", "--lazy", str(folder)], check=True)
    made = folder / f"sendworthy-{os.getpid()}"
    made.mkdir()
    stack.callback(made.rmdir)
    return made


def test_without_more_memory_samples_go_on(play, group):
    """Much more is published than the limit has room for, so queues are full; afterwards all is as before."""
    program = ("-c", GROUPED.format(procs=str(group / "cgroup.procs")))
    scene = play(size=50_000, limit="2 Mbit/s", programs={"a": program})
    with Tight(group) as fault:
        for _ in range(3):
            scene.go_on()
        print(f"the limit was hit {fault.hits()} times")
    scene.go_on()
    scene.meet()
    assert scene.finish()["dropped"] > 0
