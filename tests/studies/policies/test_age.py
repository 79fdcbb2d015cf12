"""Whittle's index for weighted age as a policy."""

import pytest

from planner import Constraint, Linear, Message, Problem, Stream
from planner.constraints import violations
from studies.central import CentralDecider
from studies.policies import by_age, whenever_it_fits
from studies.workload import SCENARIOS, mission


def window(*messages, current, limit=1.0):
    """A window of messages given by stream, time, weight, use, and whether it was sent."""
    rows = [Message(s, t, t, t + 0.01, Linear(1.0, 0.2), weight, (use,), sent) for s, t, weight, use, sent in messages]
    return Problem(
        tuple(Stream(i) for i in range(3)), tuple(rows), current, (Constraint("c", 1.0, limit),), (), 0.0, 20.0
    )


def test_the_greater_weighted_square_of_age_gets_the_room():
    """At 10 s a stream shown from 4 s on with weight 1 is worth 18, one shown from 7.1 s on with weight 4 17.6."""
    facts = [(0, 4.0, 1.0, 1.0, True), (1, 7.1, 4.0, 1.0, True)]
    assert by_age(window(*facts, (0, 10.0, 1.0, 1.0, False), (1, 10.07, 4.0, 1.0, False), current=2))
    assert not by_age(window(*facts, (0, 10.0, 1.0, 1.0, False), (1, 10.2, 4.0, 1.0, False), current=2))


def test_a_stream_of_which_nothing_was_sent_is_as_old_as_the_mission():
    """Its first message takes away all of that."""
    facts = [(0, 4.0, 1.0, 1.0, True)]
    assert not by_age(window(*facts, (0, 10.0, 1.0, 1.0, False), (1, 10.5, 1.0, 1.0, False), current=1))
    assert by_age(window(*facts, (1, 10.0, 1.0, 1.0, False), (0, 10.5, 1.0, 1.0, False), current=1))


def test_only_the_next_message_of_a_stream_within_the_window_competes():
    """Later ones of a rival, and of the own stream, and those beyond the window, take no room."""
    own, rival = (0, 10.0, 1.0, 1.0, False), (1, 10.5, 0.5, 1.0, False)
    later = [(0, 10.6, 1.0, 1.0, False), (1, 10.9, 0.5, 1.0, False), (2, 11.5, 99.0, 1.0, False)]
    assert by_age(window(own, rival, *later, current=0))
    assert by_age(window(own, rival, *later, current=0, limit=2.0))


def test_what_uses_less_of_the_limit_comes_first():
    """Index per share of the limit."""
    small, large = (1, 10.5, 1.0, 0.5, False), (1, 10.5, 1.0, 1.0, False)
    assert not by_age(window((0, 10.0, 1.0, 1.0, False), small, current=0))
    assert by_age(window((0, 10.0, 1.2, 1.0, False), large, current=0))


@pytest.mark.full
@pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda scenario: scenario.name)
def test_flights_break_no_constraint_and_beat_sending_whenever_it_fits(scenario):
    """It does plan for nothing but age, which is better than nothing where weights differ."""
    flown = mission(scenario, seed=0, seconds=20.0, constraint=Constraint("messages", 2.5, 5.0))
    sends = CentralDecider(flown, 30, forecast=True).fly(by_age)
    assert sends
    assert violations(flown, sends) == []
    greedy = CentralDecider(flown, 30, forecast=True).fly(whenever_it_fits)
    if scenario.name != "most important":
        weight = [sum(flown.messages[i].scale for i in one) for one in (sends, greedy)]
        assert weight[0] > weight[1]
