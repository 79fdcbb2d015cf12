"""Flights and what is measured of them."""

import json
from functools import cache

import pytest

from planner import Aggregation
from studies.simulation.conditions import WARM_UP
from studies.study.flying import fly_one
from studies.study.missions import mission_of
from studies.study.programme import bound_of
from studies.study.tasks import Task

TASK = Task("best", "mixed", 5.0, 0, network="own", robots=4, seconds=8.0, iterations=30)


@cache
def bound(task):
    """What nobody exceeds; the same for all who fly a mission."""
    return fly_one(bound_of(task))


def test_a_flight_keeps_to_the_limit_and_below_the_bound():
    """And its record is JSON."""
    found, most = fly_one(TASK), bound(TASK)
    assert json.loads(json.dumps(found)) == found
    assert 0.5 * most["utility"] < found["utility"] <= most["utility"] * (1 + 1e-6)
    assert most["utility"] < found["maximum"] == most["maximum"]
    assert found["worst"] <= 1.0
    assert found["over"] == 0.0
    assert found["sent"] < found["generated"]
    assert found["received"] == pytest.approx(found["sent"])
    assert found["network"]["arrived"] == 1.0
    assert 0.003 < found["network"]["delay"][0] < 0.008


def test_what_is_lost_is_not_received():
    """By as much as the loss says, in the mean."""
    found = fly_one(TASK.but(loss=0.3, level=10.0))
    assert found["network"]["arrived"] == pytest.approx(0.7, abs=0.15)
    assert found["received"] == pytest.approx(found["sent"] * found["network"]["arrived"], rel=0.1)


def test_one_who_decides_for_all_is_bounded_too():
    """And sends whole messages."""
    found, most = fly_one(TASK.but(contender="central")), bound(TASK)
    assert found["utility"] <= most["utility"] * (1 + 1e-6)
    assert found["sent"] == int(found["sent"])


@pytest.mark.full
def test_an_operator_receives_where_messages_go_to_one():
    """Each of them is received once."""
    found = fly_one(TASK.but(unicast=True))
    assert found["received"] == pytest.approx(found["sent"])


REAL = Task("best", "real-random", 0.0, 0, network="own", unicast=True, robots=3, seconds=6.0, iterations=30)


@pytest.mark.parametrize("contender", ["best", "central", "reserve", "static"])
def test_real_traffic_is_flown_below_its_bound(contender):
    """By a team, by one for all, and by those who do not plan; nobody who knows all exceeds the limit."""
    found, most = fly_one(REAL.but(contender=contender)), bound(REAL)
    assert json.loads(json.dumps(found)) == found
    assert 0.2 * most["utility"] < found["utility"] <= most["utility"] * (1 + 1e-6)
    assert most["utility"] < found["maximum"] == most["maximum"]
    assert found["received"] <= found["sent"] < found["generated"]
    assert found["worst"] <= (1.5 if contender == "best" else 1.0)
    assert bool(found["decision"]) == (contender == "best")


@pytest.mark.full
def test_small_samples_of_real_traffic_arrive():
    """Soon, whatever becomes of images."""
    found = fly_one(REAL.but(scenario="real-mixed", robots=2, network="own"))
    assert found["small"] == found["alarms"] == 1.0
    assert found["age"][0] < 0.01
    assert found["sent"] < found["generated"]


def test_missions_are_changed_in_what_the_task_says_alone():
    """So many messages of the same worth, at other times, in other windows, of other streams."""
    plain = mission_of(TASK).problem
    aperiodic = mission_of(TASK.but(generation="aperiodic")).problem
    assert sorted(m.scale for m in aperiodic.messages) == sorted(m.scale for m in plain.messages)
    assert [m.t_gen for m in aperiodic.messages] != [m.t_gen for m in plain.messages]
    assert all(m.t_rcv - m.t_gen == pytest.approx(0.004) for m in aperiodic.messages)
    short = mission_of(TASK.but(window=0.5))
    assert (short.problem.constraints[0].window, short.problem.constraints[0].limit) == (0.5, 1.0)
    assert short.problem.messages == plain.messages
    mixed = mission_of(TASK.but(aggregation="mixed"))
    assert [s.aggregation for s in mixed.problem.streams] == [Aggregation.SUM, Aggregation.MOST_RECENT] * 2
    assert [t.aggregation for t in mixed.specs.types] == [s.aggregation for s in mixed.problem.streams]
    assert plain.t_end == WARM_UP + TASK.seconds


@pytest.mark.full
@pytest.mark.parametrize("scenario", ["few", "mixed", "most"])
def test_both_networks_let_a_team_reach_the_same(scenario):
    """Within two points of the bound, where the channel is not saturated."""
    tasks = [Task("best", scenario, 5.0, seed, seconds=60.0) for seed in (0, 1)]
    flights = [fly_one(task.but(network=network)) for network in ("adhoc", "own") for task in tasks]
    bounds = [fly_one(bound_of(task))["utility"] for task in tasks]
    shares = [sum(flight["utility"] for flight in each) / sum(bounds) for each in (flights[:2], flights[2:])]
    assert all(flight["network"]["arrived"] > 0.995 for flight in flights)
    assert abs(shares[0] - shares[1]) < 0.02
