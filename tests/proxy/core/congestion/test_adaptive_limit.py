"""What is in force of one adaptive limit."""

import pytest

from planner import Throughput
from proxy.core.congestion.adaptive_limit import AdaptiveLimit
from proxy.core.congestion.aimd import Aimd
from proxy.core.congestion.capacity_reports import CapacityReports
from proxy.core.model.limits import Limit
from proxy.core.protocol.messages import Digest

AIR = Limit("air", 0.5, 5e4, Throughput(1e5), 0.05)


@pytest.fixture
def limit():
    aimd = Aimd(0.0, AIR.least)
    aimd.restore(0.5)
    return AdaptiveLimit(0.0, 0, AIR, aimd)


def reports(leader="", **capacities):
    """Reports of robots on the limit, by name."""
    made = CapacityReports("us")
    for robot, capacity in capacities.items():
        made.note(0.0, Digest(robot, robot, 0.0, 0, 0, capacity=(capacity,)))
    made.set_leader(0.0, leader)
    return made


def test_a_new_limit_is_in_force_as_it_is_estimated(limit):
    """Nobody has said anything."""
    assert limit.in_force == limit.lasting == limit.drained == 0.5
    assert limit.objects


def test_the_least_of_our_estimate_and_the_reports_is_in_force(limit):
    """While nobody leads our estimate stays."""
    limit.combine(0.0, reports(op=0.3), 1.0, ("op",), 0.0)
    limit.take_turn(0.0, 0, 2)
    assert limit.in_force == limit.others == 0.3
    assert limit.aimd.estimate == 0.5
    assert not limit.objects


def test_a_follower_takes_over_what_its_leader_reports(limit):
    """Where it is less."""
    limit.combine(0.0, reports("op", op=0.3), 1.0, (), 0.0)
    assert limit.aimd.estimate == limit.lasting == 0.3


def test_a_leader_decreases_its_estimate_by_what_others_report(limit):
    """And drains the queue that it sees itself."""
    limit.combine(0.0, reports("us", op=0.3), 1.0, ("op",), 0.2)
    assert limit.lasting == 0.3
    assert limit.drained == pytest.approx(0.3 * 0.6)


def test_who_is_not_first_begins_anew_in_its_place(limit):
    """The window is divided among all; the first robot does not wait."""
    for place in (1, 0):
        limit.combine(1.0, reports("op", op=0.5), 0.2, (), 0.0)
        limit.take_turn(1.0, place, 2)
        limit.combine(1.2, reports("op", op=0.5), 1.0, (), 0.0)
        limit.take_turn(1.2, place, 2)
        assert limit.in_force == (0.2 if place else 0.5)
