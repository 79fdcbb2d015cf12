"""Robots that vanish without a word are noticed soon, and so is their return."""

import time

import pytest

from tests.system.robots import wait_until_met
from tests.waiting import wait_until

pytestmark = pytest.mark.system

SOON = 5.0
"""A robot is silent for 2 s before it counts as gone; a look at all others' status takes a second or two [s]."""


@pytest.mark.parametrize(
    ("vanish", "come_back"),
    [
        (lambda robot: robot.host.radio("down"), lambda robot: robot.host.radio("up")),
        (lambda robot: robot.host.range(within=False), lambda robot: robot.host.range(within=True)),
        (lambda robot: robot.kill(), lambda robot: robot.start()),
    ],
    ids=["radio off", "out of range", "killed"],
)
def test_a_robot_that_vanishes_is_gone_and_comes_back(team, vanish, come_back):
    """Without a word of goodbye it is no peer any more within seconds; once it is back, all know each other again."""
    lost, *others = robots = team()
    vanish(lost)
    t = time.monotonic()
    wait_until_met(others, SOON)
    print("gone", time.monotonic() - t)
    come_back(lost)
    wait_until(lost.serves, what=f"start of {lost.name}")
    t = time.monotonic()
    wait_until_met(robots, 30)
    print("back", time.monotonic() - t)


@pytest.mark.parametrize(
    "vanish",
    [lambda host: host.radio("down"), lambda host: host.range(within=False)],
    ids=["radio off", "out of range"],
)
def test_who_vanishes_misses_the_others_as_soon(team, vanish):
    """Neither end may take the link for alive much longer than the other: that is how connections become half open."""
    lost, *_ = team()
    vanish(lost.host)
    wait_until(lambda: not lost.peers(), SOON, "that the others are gone")
