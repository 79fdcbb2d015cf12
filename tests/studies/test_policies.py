"""The policies one compares with."""

from dataclasses import replace

import pytest

from planner import Constraint, Linear, Message, Problem, SearchSettings, Stream
from studies.policies import Planned, by_rank, whenever_it_fits

POLICIES = [
    whenever_it_fits,
    by_rank,
    Planned(SearchSettings(search="paper"), 500),
    Planned(SearchSettings(search="best"), 100),
]


def window(*, first, second):
    """Two messages of two robots that compete for room for one; `first` is to be decided."""
    messages = tuple(
        Message(i, 0.1 * i, 0.1 * i, 0.1 * i + 0.01, Linear(1.0, 0.2), scale, (1.0,))
        for i, scale in enumerate((first, second))
    )
    return Problem((Stream(0), Stream(1)), messages, 0, (Constraint("messages", 0.5, 1.0),), (), 0.0, 3.0)


@pytest.mark.parametrize("policy", POLICIES)
def test_the_more_important_message_is_sent(policy):
    """All policies send the message that is worth more when it comes first."""
    assert policy(window(first=100.0, second=1.0))


@pytest.mark.parametrize("policy", POLICIES[1:])
def test_room_is_kept_for_the_more_important_message(policy):
    """All but the greedy one leave the room to the next message when that is worth more."""
    assert not policy(window(first=1.0, second=100.0))
    assert whenever_it_fits(window(first=1.0, second=100.0))


@pytest.mark.parametrize("policy", POLICIES)
def test_nothing_is_sent_without_room(policy):
    """When the window is used up no policy sends."""
    free = window(first=100.0, second=1.0)
    first, second = free.messages
    full = replace(free, messages=(replace(first, sent=True), second), current=1)
    assert not policy(full)


def test_rank_does_not_waste_room_on_the_worthless():
    """What adds nothing is not sent, even where there is room."""
    assert not by_rank(window(first=0.0, second=0.0))


def test_rank_counts_what_a_message_uses():
    """Of two equally worthy messages the smaller one goes first; one that uses nothing before all."""
    equal = window(first=1.0, second=1.0)
    first, second = equal.messages
    assert not by_rank(replace(equal, messages=(first, replace(second, use=(0.5,)))))
    assert by_rank(replace(equal, messages=(replace(first, use=(0.0,)), replace(second, use=(0.5,)))))
