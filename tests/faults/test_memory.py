"""The kernel gives a daemon no more memory than it has."""

import subprocess

import pytest

from tests.faults.scene import Fault
from tests.waiting import wait_until

pytestmark = pytest.mark.system
MORE = 1 << 20
"""What a daemon may take beyond what it has, its files in memory included [B]."""


class Tight(Fault):
    """A daemon is in a group that may hold little more than it does: the kernel takes from it what it can."""

    def __init__(self, folder, robot):
        self._group = folder / f"daemon-{robot.pid}"
        self._pid = robot.pid

    def start(self):
        self._group.mkdir()
        (self._group / "memory.move_charge_at_immigrate").write_text("3")
        (self._group / "cgroup.procs").write_text(str(self._pid))
        held = int((self._group / "memory.usage_in_bytes").read_text())
        (self._group / "memory.limit_in_bytes").write_text(str(held + MORE))

    def pressed(self):
        """How often the limit was hit."""
        return int((self._group / "memory.failcnt").read_text())

    def stop(self):
        (self._group / "memory.limit_in_bytes").write_text("-1")
        (self._group.parent / "cgroup.procs").write_text(str(self._pid))
        self._group.rmdir()


@pytest.fixture
def groups(tmp_path, stack):
    """The groups of processes for which the kernel counts memory."""
    folder = tmp_path / "groups"
    folder.mkdir()
    if subprocess.run(["mount", "-t", "cgroup", "-o", "memory", "cgroup", str(folder)], check=False).returncode:
        pytest.skip("this kernel counts memory in another way")
    stack.callback(subprocess.run, ["umount", str(folder)], check=True)
    return folder


def test_without_more_memory_samples_go_on(play, groups):
    """Also more and larger ones than before, of which most are dropped; afterwards all is as before."""
    scene = play(size=20_000, limit="2 Mbit/s")
    with Tight(groups, scene.first) as fault:
        wait_until(fault.pressed, 60.0, "the limit to be hit")
        for _ in range(5):
            scene.go_on()
        print(f"the limit was hit {fault.pressed()} times")
    scene.go_on()
    scene.meet()
    assert scene.finish()["dropped"] > 0
