"""The kernel gives a daemon no more memory than it has."""

import os
import subprocess
import sys

import pytest

from tests.faults.scene import Fault
from tests.waiting import wait_until

pytestmark = pytest.mark.system
MORE = 8 << 20
"""What a daemon may take beyond what it holds when it has its first samples out [B]."""
WRITTEN = 4 * MORE
"""What its neighbour writes again and again: so much does not fit beside the daemon [B]."""
GROUPED = """
with open({procs!r}, "w") as group:
    group.write("0")
"""
"""The beginning of a program that puts itself into a group."""
DAEMON = """
import sys
from proxy.cli import main
sys.exit(main())
"""
NEIGHBOUR = """
while True:
    with open({file!r}, "wb", buffering=0) as file:
        for _ in range({times}):
            file.write(bytes(1 << 16))
"""


def in_group(group, program):
    """What Python is to be called with for a program that runs in a group."""
    return ("-c", GROUPED.format(procs=str(group / "cgroup.procs")) + program)


class Tight(Fault):
    """A daemon has little more memory than it holds, and a neighbour that always asks for all of it.

    What the neighbour holds are pages of a file, which the kernel can take back: each page that the daemon asks for
    has to be taken from there.
    """

    def __init__(self, group, file):
        self._group, self._file = group, file

    def start(self):
        held = int((self._group / "memory.usage_in_bytes").read_text())
        (self._group / "memory.limit_in_bytes").write_text(str(held + MORE))
        program = in_group(self._group, NEIGHBOUR.format(file=str(self._file), times=WRITTEN >> 16))
        self._neighbour = subprocess.Popen([sys.executable, "-S", *program])
        wait_until(lambda: self.hits() > 0, 60.0, "the limit to be hit")

    def hits(self):
        """How often there was no more."""
        return int((self._group / "memory.failcnt").read_text())

    def stop(self):
        self._neighbour.kill()
        self._neighbour.wait()
        (self._group / "memory.limit_in_bytes").write_text("-1")


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


def test_without_more_memory_samples_go_on(play, group, tmp_path):
    """Much more is published than the limit has room for, so queues are full; afterwards all is as before."""
    scene = play(size=50_000, limit="2 Mbit/s", programs={"a": in_group(group, DAEMON)})
    with Tight(group, tmp_path / "file") as fault:
        for _ in range(3):
            hits = fault.hits()
            wait_until(lambda hits=hits: fault.hits() > hits, what="the limit to be hit again")
            scene.go_on()
        print(f"the limit was hit {fault.hits()} times")
    scene.go_on()
    scene.meet()
    assert scene.finish()["dropped"] > 0
