"""A daemon stands still, for longer than others put up with, and goes on."""

import os
import signal

import pytest

from tests.faults.scene import Fault
from tests.waiting import wait_until

pytestmark = pytest.mark.full


class Frozen(Fault):
    """A daemon gets no time at all, as when its machine sleeps."""

    def __init__(self, robot):
        self._pid = robot.pid

    def start(self):
        os.kill(self._pid, signal.SIGSTOP)

    def stop(self):
        os.kill(self._pid, signal.SIGCONT)


def test_a_robot_that_freezes_harms_nobody_and_comes_back(play):
    """It is given up after Zenoh's lease, here of 3 s; then it is back, and hears and is heard as before."""
    scene = play(names="abc", options=("--mesh.zenoh.transport.link.tx.lease", "3000"))
    with Frozen(scene.robots["b"]):
        scene.go_on(listeners=[scene.local, scene.remote[1]])
        wait_until(lambda: scene.first.peers() == {"c"}, 30.0, "the loss to be noticed")
        scene.go_on(listeners=[scene.local, scene.remote[1]])
    scene.meet()
    scene.go_on()
    assert "nothing is heard of it" not in scene.first.log()
    scene.finish()


def test_a_publishers_daemon_that_freezes_loses_nothing_without_a_reason(play):
    """Its applications wait, and go on; what comes of that is decided and counted like everything else."""
    scene = play(size=10_000, limit="2 Mbit/s")
    with Frozen(scene.first):
        others = scene.others[0].daemon
        wait_until(lambda: others.status()["streams"][0]["age"] > 2.0, what="two seconds without a sample")
    scene.go_on()
    counts = scene.finish()
    assert counts["dropped"] > 0
