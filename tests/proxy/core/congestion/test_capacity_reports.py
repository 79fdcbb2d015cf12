"""Whose word on adaptive limits counts."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import Throughput
from proxy.core.congestion.capacity_reports import BRIEFLY, FRESH, Words
from proxy.core.model.limits import Limit
from proxy.core.protocol.messages import Digest

AIR = Limit("air", 0.5, 5e4, Throughput(1e5), 0.05)


def spoken(**told):
    """Words of robots, by name, all at once."""
    words = Words("us")
    for robot, capacity in told.items():
        words.note(0.0, Digest(robot, robot, 0.0, 0, 0, capacity=capacity))
    return words


def test_without_a_leader_the_least_counts_but_not_that_of_a_single_one():
    """Unless it is the only one, or the only one that our samples go to; and only what is fresh."""
    words = spoken(a=(0.3,), b=(0.5,), c=(0.7,))
    assert words.bound(1.0, 0, AIR, ()) == 0.5
    assert words.bound(1.0, 0, AIR, ("a",)) == 0.3
    assert words.least(1.0, 0) == 0.3
    assert words.bound(FRESH + 1.0, 0, AIR, ()) == 1.0
    assert words.least(FRESH + 1.0, 0) == 0.0
    words.forget("b")
    assert words.bound(1.0, 0, AIR, ()) == 0.7
    assert words.bound(1.0, 1, AIR, ()) == 1.0


@given(st.lists(st.floats(-1.0, 2.0), max_size=5), st.booleans())
def test_whatever_is_told_stays_between_floor_and_ceiling(told, ours):
    """Of any robot."""
    words = spoken(**{f"r{i}": (part,) for i, part in enumerate(told)})
    assert AIR.least <= words.bound(0.0, 0, AIR, ("r0", "r1") if ours else ()) <= 1.0


def test_who_follows_hears_the_leader_alone():
    """What it has in force, how much all use, and for a moment what drains."""
    words = spoken(a=(0.3,), op=(0.6, 0.4, 0.2))
    words.follow(0.1, "op")
    assert words.follows
    assert not words.leads
    assert words.bound(0.1, 0, AIR, ("a",)) == 0.6
    assert words.used((AIR,)) == (0.4,)
    assert words.draining(0.1, 0, 1) == 0.2
    assert words.draining(BRIEFLY + 0.1, 0, 1) == 1.0
    assert words.draining(0.1, 0, 2) == 1.0
    assert words.used((AIR, AIR, AIR)) is None


def test_a_leader_that_has_said_nothing_for_long_is_followed_no_more():
    """Then all have a word."""
    words = spoken(op=(0.6, 0.4))
    words.note(2.0 * FRESH, Digest("a", "a", 2.0 * FRESH, capacity=(0.3,)))
    words.follow(2.0 * FRESH, "op")
    assert not words.follows
    assert words.bound(2.0 * FRESH, 0, AIR, ()) == 0.3


@pytest.mark.parametrize("leader", ["us", "unheard", ""])
def test_nobody_follows_itself_nor_whom_it_has_not_heard(leader):
    """Then all have a word."""
    words = spoken(a=(0.3,))
    words.follow(0.0, leader)
    assert not words.follows
    assert words.leads is (leader == "us")
    assert words.bound(0.0, 0, AIR, ()) == 0.3
    assert words.used((AIR,)) is None
    assert words.draining(0.0, 0, 1) == 1.0
