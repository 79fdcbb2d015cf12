"""Shares move towards the higher marginal utility per unit, in whole messages."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import Linear, Video
from proxy.core.allocation import KEEP, MARGIN, Claim, Gift, Room, gifts, marginals, targets

ONE = 100.0 * MARGIN
"""What one message of a claim needs."""


def claim(robot, *, scale=1.0, use=100.0, period=0.1, age=1.0, last=None, wait=0.05, utility=None):
    return Claim(robot, (use,), scale, utility or Video(), period, 0.01, age, scale if last is None else last, wait)


def shared(claims, limit, window, held):
    """The targets under one constraint."""
    (target,) = targets(claims, [Room(limit, window, held)])
    return target


def test_marginal_utility_does_not_increase():
    """Every further message per window is worth at most as much as the one before, and no more than are generated."""
    worth = marginals(claim("a"), 1.0, 100.0)
    assert len(worth) == 10
    assert worth == sorted(worth, reverse=True)
    assert worth[-1] > 0.0


def test_who_generates_nothing_within_the_window_needs_nothing():
    """So robots take turns where the limit carries fewer messages than there are robots."""
    assert marginals(claim("a", wait=1.5), 1.0, 100.0) == []
    turns = [claim("a", period=1.0, wait=0.9, age=1.0), claim("b", period=1.0, wait=0.1, age=1.0)]
    assert shared(turns, 110.0, 0.5, {"a": 55.0, "b": 55.0}) == {"b": pytest.approx(ONE)}


def test_what_was_not_heard_of_for_longest_comes_first():
    """Of equal streams the stalest gets the one message that fits."""
    stale, fresh = claim("a", age=3.0, period=1.0), claim("b", age=1.0, period=1.0)
    assert set(shared([fresh, stale], 110.0, 0.5, {})) == {"a"}


def test_who_sent_something_better_than_it_has_now_needs_nothing():
    """A fresh message of little value would only hide the old one of great value."""
    assert max(marginals(claim("a", scale=1.0, last=10.0, age=0.1), 1.0, 100.0)) <= 0.0
    assert marginals(claim("a", scale=1.0, last=10.0, age=9.0), 1.0, 100.0)[0] > 0.0


def test_equal_robots_get_equal_targets():
    """Four cameras share ten messages per window as 2 to 3 each."""
    target = shared([claim(r) for r in "abcd"], 10.1 * ONE, 1.0, {})
    counts = sorted(round(amount / ONE) for amount in target.values())
    assert counts == [2, 2, 3, 3]


def test_the_better_stream_gets_more_in_proportion_to_its_value():
    """With logarithmic utility the rates follow the scales."""
    claims = [claim("a", scale=3.0, period=0.01), claim("b", period=0.01)]
    target = shared(claims, 12.1 * ONE, 1.0, {})
    assert (target["a"], target["b"]) == (pytest.approx(9 * ONE), pytest.approx(3 * ONE))


def test_small_differences_move_nothing():
    """What a robot holds must be worth clearly more elsewhere before it moves."""
    held = {"a": 2 * ONE, "b": ONE}
    claims = [claim("a"), claim("b", scale=0.9 * KEEP)]
    assert shared(claims, 3.01 * ONE, 1.0, held) == pytest.approx(held)


def test_what_is_scarce_is_given_only_to_who_can_use_it():
    """Four messages fit by their number, but only two by their bytes: both rooms go to the same robots."""
    claims = [
        replace(claim(r, scale=scale, period=1.0), use=(1.0, 100.0))
        for r, scale in zip("abcd", (4, 3, 2, 1), strict=True)
    ]
    rooms = [Room(4.1, 1.0, {"c": 2.0, "d": 2.1}), Room(2.1 * ONE, 1.0, {"a": ONE, "b": ONE})]
    assert targets(claims, rooms) == [
        {"a": pytest.approx(MARGIN), "b": pytest.approx(MARGIN)},
        {"a": pytest.approx(ONE), "b": pytest.approx(ONE)},
    ]


def test_a_shorter_window_sees_a_part_of_the_messages():
    """Three messages within 1 s are at most two within 0.5 s, and the room for those is needed."""
    (one,) = [replace(claim("a", period=0.3), use=(1.0, 100.0))]
    rooms = [Room(3.1, 1.0, {}), Room(1000.0, 0.5, {})]
    assert targets([one], rooms) == [{"a": pytest.approx(3 * MARGIN)}, {"a": pytest.approx(2 * ONE)}]


def test_what_a_room_cannot_carry_alone_is_not_wanted_in_another():
    """Where a message is larger than one limit, it takes nothing of the other."""
    rooms = [Room(10.0, 1.0, {}), Room(50.0, 1.0, {})]
    assert targets([replace(claim("a"), use=(1.0, 100.0))], rooms) == [{}, {}]


def test_gifts_go_from_who_has_most_to_who_lacks_most():
    """Each gift names both sides, so that all robots work out the same ones."""
    assert gifts({"a": 50.0, "b": 30.0}, {"a": 10.0, "b": 10.0, "c": 35.0, "d": 45.0}, 1.0) == [
        Gift("d", "a", 40.0),
        Gift("d", "b", 5.0),
        Gift("c", "b", 15.0),
    ]


@given(
    st.lists(st.tuples(st.sampled_from("abcde"), st.floats(0.1, 50.0), st.floats(1.0, 500.0)), max_size=8),
    st.floats(0.0, 3000.0),
    st.lists(st.floats(0.0, 1000.0), min_size=5, max_size=5),
)
def test_targets_and_gifts_create_nothing(entries, limit, amounts):
    """Targets never exceed the limit, no robot gives more than it holds, and gifts sum to zero."""
    claims = [claim(r, scale=scale, use=use, utility=Linear(1.0, 0.3)) for r, scale, use in entries]
    held = dict(zip("abcde", amounts, strict=True))
    target = shared(claims, limit, 1.0, held)
    assert sum(target.values()) <= limit + 1e-6
    for robot, amount in held.items():
        given_away = sum(gift.amount for gift in gifts(target, held, 1.0) if gift.giver == robot)
        assert given_away <= max(0.0, amount - target.get(robot, 0.0)) + 1e-6
