"""One robot that is slow, or takes nothing any more, holds up the others by a bounded time only."""

import os
import signal

import pytest

from proxy.bridge.tuning import TUNING
from tests.waiting import wait_until

pytestmark = pytest.mark.system

RATE = 150
"""Samples a second; none may be dropped on its way to a robot that keeps up."""
SLACK = 0.75
"""What two cores that run three robots may add [s]."""


def stop_reading(robot):
    """Freeze the daemon: its sockets fill up."""
    os.kill(robot.daemon.pid, signal.SIGSTOP)


def receive_slowly(robot):
    """As at the edge of the radio's range."""
    robot.host.slow_reception("200kbit")


@pytest.fixture(params=[stop_reading, receive_slowly])
def hinder(request):
    return request.param


def test_one_slow_robot_delays_the_others_by_a_bounded_time(team, hinder):
    """Samples that may not be dropped reach a robot that keeps up, all of them and none late."""
    speaking, listening, slow = team()
    heard = [robot.hear("bulk") for robot in (listening, slow)]
    speaker = speaking.say("bulk", size=5000, rate=RATE, block=True)
    wait_until(lambda: all(listener.numbers("bulk") for listener in heard), what="the samples at both")
    before = len(heard[0].numbers("bulk"))
    hinder(slow)
    wait_until(lambda: len(heard[0].numbers("bulk")) >= before + 6 * RATE, 30, "six seconds of samples")
    total = speaker.stop()
    wait_until(lambda: heard[0].numbers("bulk")[-1] == total - 1, what="the last sample")
    numbers = heard[0].numbers("bulk")
    print(f"lost {sorted(set(range(numbers[0], total)) - set(numbers))}")
    assert numbers == list(range(numbers[0], total))
    late = max(sample["heard"] - sample["sent"] for sample in heard[0].heard("bulk"))
    print(f"longest delay {late:.3f} s")
    assert late < TUNING.slow_link_wait + SLACK
    slow.daemon.send_signal(signal.SIGCONT)
