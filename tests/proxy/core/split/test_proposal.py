"""Which bids are worth an agreement."""

import pytest

from proxy.core.protocol.bid import Segment
from proxy.core.split.split import indifferent, outdoes_equal
from proxy.core.split.tuning import TUNING
from tests.proxy.core.split.agreeing import agree, robot


def test_all_agree_on_other_slots_where_that_is_worth_it():
    """Who may use a slot longer gains little more than the other loses, unless its messages are worth far more."""

    def frames(level):
        return tuple(Segment(6000, level - less, quarters) for less, quarters in ((0, 1), (2, 1), (4, 2)))

    a, b = robot("a", "b"), robot("b", "a")
    for each in (a, b):
        each.ask(0.0, frames(100))
    agree(0.1, a, b)
    assert not a.pending
    for level, ring in ((97, {"a": 1, "b": 3}), (103, {"a": 3, "b": 1})):
        assert dict(a.log.newest.allocated({"a": frames(level), "b": frames(100)}).slots[0].ring) == ring
        assert indifferent(a, frames(level))
    assert not indifferent(a, frames(110))


def test_where_it_takes_long_to_agree_all_have_to_gain_more_by_that():
    """What each has rests meanwhile. Who asked for nothing so far tells what it needs, or others get that."""
    a, b = robot("a", "b"), robot("b", "a")
    a.ask(0.0, (Segment(3000, 100),))
    b.ask(0.0, (Segment(9000, 98),))
    agree(0.1, a, b)
    more = (Segment(4500, 100),)
    assert not indifferent(a, more, 0.01 * TUNING.gains_for)
    assert indifferent(a, more, 0.1 * TUNING.gains_for)
    assert not indifferent(a, (Segment(4500, 130),), 0.1 * TUNING.gains_for)
    a.ask(0.2, ())
    agree(0.3, a, b)
    assert not indifferent(a, (Segment(1000, 90),), TUNING.gains_for)


def test_slots_that_are_a_bit_smaller_than_what_is_asked_for_are_worth_something():
    """Most messages fit them: it is the largest that are asked for."""
    a, b = robot("a", "b"), robot("b", "a")
    for each in (a, b):
        each.ask(0.0, (Segment(6000, 100, 2),))
    agree(0.1, a, b)
    had, usual = a.log.newest.allocation, b.bid[1]
    worth = had.worth({"a": usual, "b": usual})
    assert had.worth({"a": (Segment(6500, 100, 2),), "b": usual}) > worth
    assert had.worth({"a": (Segment(7000, 100, 2),), "b": usual}) == pytest.approx(worth / 2.0)


def test_a_larger_message_is_asked_for_though_all_together_gain_little():
    """And divisible room, whose worth is not known as well, is never left to slots."""
    robots = [robot(tag, "abcdefghij".replace(tag, "")) for tag in "abcdefghij"]
    for each in robots:
        each.ask(0.0, (Segment(900, 100, 4),))
    agree(0.1, *robots)
    first, second, *_ = robots
    larger = (Segment(1300, 94, 4),)
    bids = {each.own: each.bid[1] for each in robots} | {first.own: larger}
    assert first.log.newest.allocated(bids).worth(bids) < (1.0 + TUNING.slot_gain) * first.log.newest.allocation.worth(
        bids
    )
    assert not indifferent(first, larger)
    for each in robots:
        each.ask(0.2, (Segment(2000, 100, 4),))
    agree(0.3, *robots)
    assert indifferent(first, (Segment(2000, 98, 4),))
    second.ask(0.4, (Segment(900, 100),))
    agree(0.5, *robots)
    assert not indifferent(first, (Segment(2000, 98, 4),))


def test_parts_outdo_equal_ones_where_what_few_ask_for_is_worth_more():
    """Not before all agreed, nor where all ask for the same."""
    for level, outdoes in ((100, False), (140, True)):
        robots = [robot(tag, "abcd".replace(tag, "")) for tag in "abcd"]
        for each in robots:
            each.ask(0.0, (Segment(4000, level if each.own == "a" else 100, 4),))
        assert not outdoes_equal(robots[0])
        agree(0.1, *robots)
        assert [outdoes_equal(each) for each in robots] == [outdoes] * 4
