"""Flights of robots that decide alone."""

from dataclasses import replace

import pytest

from planner import SearchSettings
from studies.alone.flight import fly_alone
from studies.ns3.network import Ns3Network
from studies.ns3.radio import Radio
from studies.oracle import upper_bound
from studies.policies import Planned, RandomSends, send_all, whenever_it_fits
from studies.simulation.conditions import Conditions
from studies.simulation.medium import Medium
from studies.simulation.missions import SIZE, draw
from studies.simulation.network import OverMedium
from studies.simulation.scores import reached, scored, sent
from studies.simulation.team import DECISION_TIME
from studies.simulation.usage import usage
from studies.workload import FEW_IMPORTANT, MIXED

HOW = Conditions(transport="broadcast", robots=5, limit=3, seconds=10.0, latency=0.02)
RATE = 1e7


def carried(loss=0.0, latency=0.02):
    """A network of our own with this loss and latency."""
    return lambda agenda: OverMedium(Medium(RATE, latency - SIZE / RATE, loss, seed=1), agenda)


def planned(_mission):
    """Best mode."""
    return Planned(SearchSettings(search="best"), 100)


@pytest.fixture(scope="module")
def flown():
    """A short mission of five robots that share what all ten would have."""
    return draw(MIXED, 1, HOW)


def test_who_sends_all_reaches_all(flown):
    """Every message comes to all others at the latency of the network, each decided once."""
    flight = fly_alone(flown, lambda _: send_all, carried(), seed=1)
    assert sent(flown, flight) == frozenset(range(len(flown.frames)))
    assert len(flight.decisions) == len(flown.frames)
    assert len(flight.deliveries) == 4 * len(flown.frames)
    took = [d.t_rcv - d.t_sent for d in flight.deliveries]
    assert took == pytest.approx([0.02] * len(took), abs=1e-3)
    assert all(seconds >= 0.0 for seconds in flight.decisions)
    decided = [air.t - air.frame.t_gen for air in flight.on_air]
    assert decided == pytest.approx([DECISION_TIME] * len(decided)), "decisions take as long as a team's"


def test_plans_beat_sending_whenever_it_fits_and_keep_the_limit_as_far_as_known(flown):
    """Best mode comes near to the bound though nobody tells the robots anything but what messages carry."""
    bound = upper_bound(scored(flown.problem)).bound
    best, greedy = (fly_alone(flown, fresh, carried(), seed=1) for fresh in (planned, lambda _: whenever_it_fits))
    assert reached(flown, best) > 0.93 * bound
    assert reached(flown, greedy) < 0.9 * reached(flown, best)
    assert usage(flown, best, HOW).exceeding < 0.1
    assert usage(flown, fly_alone(flown, lambda _: send_all, carried(), seed=1), HOW).exceeding > 0.5


def test_loss_makes_robots_know_less_and_costs_utility(flown):
    """What is lost is in no receiver's facts: robots send more than together they may."""
    whole, lossy = (fly_alone(flown, planned, carried(loss), seed=1) for loss in (0.0, 0.3))
    lost = [d for d in lossy.deliveries if d.t_rcv is None]
    assert 0.2 < len(lost) / len(lossy.deliveries) < 0.4
    assert reached(flown, lossy) < reached(flown, whole)
    assert usage(flown, lossy, HOW).exceeding > usage(flown, whole, HOW).exceeding


def test_the_same_seed_flies_the_same_flight_and_each_robot_draws_its_own(flown):
    """Another seed deals other numbers."""
    first, again, other = (
        sent(flown, fly_alone(flown, lambda _: RandomSends(0.5, limited=False), carried(), seed=seed))
        for seed in (1, 1, 2)
    )
    assert first == again
    assert first != other
    rows = [[i in first for i, f in enumerate(flown.frames) if f.robot == f"r{robot}"][:15] for robot in range(5)]
    assert len({tuple(row) for row in rows}) == 5


def test_copies_count_and_only_those_who_want_a_message_have_it_delivered():
    """In unicast each of the others gets a copy; the operator wants them."""
    flown = draw(MIXED, 1, replace(HOW, transport="unicast", seconds=0.0))
    flight = fly_alone(flown, lambda _: send_all, carried(), seed=1, broadcast=False)
    assert {each.size for each in flight.on_air} == {5 * SIZE}
    assert {each.receiver for each in flight.deliveries} == {"op"}


@pytest.mark.full
def test_on_ns3_flights_are_as_on_our_own_network():
    """Where the channel is far from full what best mode reaches alone differs by less than two points."""
    flown = draw(FEW_IMPORTANT, 1, replace(HOW, latency=0.004))
    bound = upper_bound(scored(flown.problem)).bound
    ours = fly_alone(flown, planned, carried(latency=0.004), seed=1)
    with Radio(5, seed=1) as radio:
        theirs = fly_alone(flown, planned, lambda a: Ns3Network(radio, a, sorted(flown.interests), 1), seed=1)
    assert all(d.t_rcv is not None for d in theirs.deliveries)
    assert reached(flown, theirs) == pytest.approx(reached(flown, ours), abs=0.02 * bound)
