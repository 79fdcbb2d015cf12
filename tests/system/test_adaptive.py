"""An adaptive limit follows what the radio carries, on real links."""

import time

import pytest

from tests.waiting import wait_until

pytestmark = pytest.mark.system

KEY = "robot/a/camera"
SIZE = 10_000
LIMIT = 'adaptive"\nceiling = "6 Mbit/s"\nfloor = "200 kbit/s'
"""What the specs of these robots have between the quotes of their limit."""
FULL, FULL_PART = 2e6 / 8, 1.0 / 3.0
"""What the radio carries at first [B/s], and as a part of the ceiling."""
STALE = 0.3
"""A sample that came through a queue that stands is later than this [s]; one takes 80 ms at half of the rate."""


@pytest.fixture
def stream(team):
    """A robot whose radio carries a third of the ceiling, what it says three times as much, and who hears that."""
    robot, listening = team("ab", limit=LIMIT)
    robot.host.slow_down("2mbit")
    heard = listening.hear(KEY)
    robot.say(KEY, size=SIZE, rate=75)
    wait_until(lambda: adaptive(robot)["in_force"] > FULL_PART - 0.05, 20, "the radio to be full")
    return robot, heard


def test_a_constant_link_is_used_and_a_halved_one_is_noticed(stream):
    """Most of it, with little delay; and when it is halved, samples are soon as new as they were.

    How much is used differs from run to run, by when the limit was decreased last: between half and all.
    """
    robot, heard = stream
    wait_until(lambda: since(heard, time.monotonic() - 12.0)[:1] and late(heard, 1.0) < STALE, 25, "a calm stream")
    before, begun = robot.host.sent(), time.monotonic()
    count = len(heard.numbers(KEY))
    wait_until(lambda: time.monotonic() >= begun + 8.0, 10, "a while")
    used = (robot.host.sent() - before) / (time.monotonic() - begun)
    assert used >= 0.45 * FULL
    assert len(heard.numbers(KEY)) - count >= 0.4 * FULL * 8.0 / SIZE
    robot.host.slow_down("1mbit")
    halved = time.monotonic()
    wait_until(lambda: late(heard, 0.5) > STALE or adaptive(robot)["in_force"] < 0.25, 10, "a queue or a lower limit")
    wait_until(lambda: late(heard, 0.5) < STALE, 10, f"the queue to drain, {halved}")
    wait_until(lambda: 0.05 < adaptive(robot)["in_force"] < 0.25, 10, "a limit below half of what it was")
    assert adaptive(robot)["floor"] == pytest.approx(0.2 / 6)


def adaptive(robot):
    """What the robot says of its limit."""
    (limit,) = robot.status()["budget"]
    return limit["adaptive"]


def since(heard, moment):
    """The samples that came after this moment [s]."""
    return [sample for sample in heard.heard(KEY) if sample["heard"] >= moment]


def late(heard, span):
    """How late the last samples were in the middle [s]; forever if none came in that time."""
    ages = sorted(sample["heard"] - sample["sent"] for sample in since(heard, time.monotonic() - span))
    return ages[len(ages) // 2] if ages else float("inf")
