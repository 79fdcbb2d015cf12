"""Whose report on adaptive limits counts."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import Throughput
from proxy.core.congestion.aimd import CapacityReports
from proxy.core.congestion.tuning import TUNING
from proxy.core.model.limits import Limit
from proxy.core.protocol.messages import Digest

AIR = Limit("air", 0.5, 5e4, Throughput(1e5), 0.05)


def reported(**capacities):
    """Reports of robots, by name, all at once."""
    reports = CapacityReports("us")
    for robot, capacity in capacities.items():
        reports.note(0.0, Digest(robot, robot, 0.0, 0, 0, capacity=capacity))
    return reports


def test_without_a_leader_the_least_counts_but_not_that_of_a_single_one():
    """Unless it is the only one, or the only one that our samples go to; and only what is fresh."""
    reports = reported(a=(0.3,), b=(0.5,), c=(0.7,))
    assert reports.bound(1.0, 0, AIR, ()) == 0.5
    assert reports.bound(1.0, 0, AIR, ("a",)) == 0.3
    assert reports.least(1.0, 0) == 0.3
    assert reports.bound(TUNING.lifetime + 1.0, 0, AIR, ()) == 1.0
    assert reports.least(TUNING.lifetime + 1.0, 0) == 0.0
    reports.forget("b")
    assert reports.bound(1.0, 0, AIR, ()) == 0.7
    assert reports.bound(1.0, 1, AIR, ()) == 1.0


@given(st.lists(st.floats(-1.0, 2.0), max_size=5), st.booleans())
def test_whatever_is_told_stays_between_floor_and_ceiling(told, ours):
    """Of any robot."""
    reports = reported(**{f"r{i}": (part,) for i, part in enumerate(told)})
    assert AIR.least <= reports.bound(0.0, 0, AIR, ("r0", "r1") if ours else ()) <= 1.0


def test_who_follows_hears_the_leader_alone():
    """What it has in force, and how much all use."""
    reports = reported(a=(0.3,), op=(0.6, 0.4))
    reports.set_leader(0.1, "op")
    assert reports.follows
    assert not reports.leads
    assert reports.bound(0.1, 0, AIR, ("a",)) == 0.6
    assert reports.used(1) == (0.4,)
    assert reports.used(3) is None


def test_a_leader_that_has_said_nothing_for_long_is_followed_no_more():
    """Then all have a word."""
    reports = reported(op=(0.6, 0.4))
    reports.note(2.0 * TUNING.lifetime, Digest("a", "a", 2.0 * TUNING.lifetime, capacity=(0.3,)))
    reports.set_leader(2.0 * TUNING.lifetime, "op")
    assert not reports.follows
    assert reports.bound(2.0 * TUNING.lifetime, 0, AIR, ()) == 0.3


@pytest.mark.parametrize("leader", ["us", "unheard", ""])
def test_nobody_follows_itself_nor_whom_it_has_not_heard(leader):
    """Then all have a word."""
    reports = reported(a=(0.3,))
    reports.set_leader(0.0, leader)
    assert not reports.follows
    assert reports.leads is (leader == "us")
    assert reports.bound(0.0, 0, AIR, ()) == 0.3
    assert reports.used(1) is None
