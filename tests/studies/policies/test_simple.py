"""The policies that do not plan, and what all policies that keep the constraints have in common."""

from dataclasses import replace

import pytest

from planner import Constraint, Linear, Message, Problem, SearchSettings, Stream
from studies.policies import FixedRate, Planned, RandomSends, Receding, by_rank, send_all, whenever_it_fits

POLICIES = [
    whenever_it_fits,
    by_rank,
    Planned(SearchSettings(search="paper"), 500),
    Planned(SearchSettings(search="best"), 100),
    Receding(),
    Receding(beyond=False),
]


def window(*, first, second):
    """Two messages of two robots that compete for room for one; `first` is to be decided."""
    messages = tuple(
        Message(i, 0.1 * i, 0.1 * i, 0.1 * i + 0.01, Linear(1.0, 0.2), scale, (1.0,))
        for i, scale in enumerate((first, second))
    )
    return Problem((Stream(0), Stream(1)), messages, 0, (Constraint("messages", 0.5, 1.0),), (), 0.0, 3.0)


def full():
    """The first message was sent and leaves no room for the second."""
    free = window(first=100.0, second=1.0)
    first, second = free.messages
    return replace(free, messages=(first._replace(sent=True), second), current=1)


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
    assert not policy(full())


def test_sending_all_ignores_the_limits():
    """It is there to compare with, not to be used."""
    assert send_all(full())


def test_random_sends_keep_the_limits_and_their_probability():
    """About so many of the messages that fit are sent, the same ones with the same seed, none without room."""
    free = window(first=1.0, second=1.0)
    first, again, other = (RandomSends(0.3, seed) for seed in (1, 1, 2))
    drawn = [first(free) for _ in range(500)]
    assert 100 < sum(drawn) < 200
    assert drawn == [again(free) for _ in range(500)]
    assert drawn != [other(free) for _ in range(500)]
    assert not any(RandomSends(1.0)(full()) for _ in range(3))


def test_random_sends_may_ignore_the_limits_and_each_hand_draws_its_own():
    """The random dropping of the paper knows no limit; where many decide, they do not all draw the same."""
    free = window(first=1.0, second=1.0)
    assert RandomSends(1.0, limited=False)(full())
    one, same, other = (RandomSends(0.3, 1, limited=False).dealt(hand) for hand in ("0 r1", "0 r1", "0 r2"))
    drawn = [one(free) for _ in range(200)]
    assert drawn == [same(free) for _ in range(200)]
    assert drawn != [other(free) for _ in range(200)]


def test_fixed_rates_need_room_too():
    """A message that is due is dropped when a constraint forbids it."""
    assert not FixedRate(0.1)(full())


def test_rank_does_not_waste_room_on_the_worthless():
    """What adds nothing is not sent, even where there is room."""
    assert not by_rank(window(first=0.0, second=0.0))


def test_rank_counts_what_a_message_uses():
    """Of two equally worthy messages the smaller one goes first; one that uses nothing before all."""
    equal = window(first=1.0, second=1.0)
    first, second = equal.messages
    assert not by_rank(replace(equal, messages=(first, second._replace(use=(0.5,)))))
    assert by_rank(replace(equal, messages=(first._replace(use=(0.0,)), second._replace(use=(0.5,)))))
