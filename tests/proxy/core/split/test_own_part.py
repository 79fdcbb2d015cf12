"""Our part of every limit as time passes, and what our sends use of it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.protocol.bid import UNIT
from proxy.core.split.own_part import Ledger, OwnPart, Steady
from proxy.core.split.split import Split
from tests.proxy.core.split.flight import FLOOR, WINDOW


def test_each_limit_has_its_own_window():
    """A message counts as what it uses of each."""
    split = Split("a", 0.0, (1.0, 2.0), floor=FLOOR, settled_at=0.0)
    split.advance(0.0, 0.0)
    split.sent(3.0, (0.5, 0.25))
    assert [split.own_part.free(3.0, limit) for limit in (0, 1)] == pytest.approx([0.48, 0.73])
    assert [split.own_part.free(4.0, limit) for limit in (0, 1)] == pytest.approx([0.98, 0.73])


def test_room_that_comes_is_used_a_window_later_and_what_goes_is_given_up_at_once():
    """What others sent in it has left the window by then."""
    part = OwnPart(0.0, (WINDOW,), 2000)
    part.entitle(5.0, 6000)
    assert part.changes_at(5.0) == part.grows_at(5.0) == 5.0 + WINDOW
    assert (part.of(5.9), part.of(5.0 + WINDOW)) == (0.2, 0.6)
    part.entitle(7.0, 1000)
    assert part.of(7.0) == 0.1


def test_what_was_sent_in_a_slot_does_not_count_when_it_is_passed_on():
    """It leaves the window with the room; so small messages go on."""
    part = OwnPart(0.0, (WINDOW,), 5000)
    part.sent(5.0, (0.4,))
    part.sent(5.1, (0.05,))
    assert part.spent(5.2, 4000)
    assert part.give_up(5.2, 1000, 4000, 1000) == 5.0
    assert part.free(5.2) == pytest.approx(0.05)
    assert part.of(5.2) == pytest.approx(0.5)
    assert part.changes_at(5.2) == 5.0 + WINDOW


def test_a_message_of_several_windows_is_busy_until_all_of_it_would_have_fitted():
    """Nothing else fits before."""
    part = OwnPart(0.0, (WINDOW,), UNIT // 2)
    part.sent(5.0, (1.5,), 3.0)
    assert part.busy_until == 5.0 + 2.0 * WINDOW
    assert part.free(5.0 + 2.9 * WINDOW) == 0.0
    assert part.free(5.0 + 3.1 * WINDOW) == 0.5


def test_what_was_sent_counts_for_as_long_as_a_window():
    """Each limit has its own window."""
    ledger = Ledger((1.0, 2.0))
    ledger.sent(5.0, (10.0, 3.0))
    assert [ledger.kept(t, 0) for t in (5.0, 5.9, 6.0)] == [10.0, 10.0, 0.0]
    assert [ledger.kept(t, 1) for t in (5.0, 6.9, 7.0)] == [3.0, 3.0, 0.0]


def test_a_large_message_is_struck_off_when_its_room_is_given_up():
    """The small ones beside it stay, and go on."""
    ledger = Ledger((1.0,))
    for t, use in ((5.0, 2.0), (5.1, 40.0), (5.2, 3.0)):
        ledger.sent(t, (use,))
    ledger.strike(5.3, 8.0, 42.0)
    assert (ledger.kept(5.3, 0), ledger.struck(5.3, 0), ledger.last_struck) == (5.0, 40.0, 5.1)
    assert ledger.next_expiry(5.3) == 6.1
    assert ledger.struck(6.1, 0) == 0.0


def test_no_more_is_struck_off_than_the_room_that_is_given_up():
    """Of what does not fit in it, a part."""
    ledger = Ledger((1.0,))
    ledger.sent(5.0, (40.0,))
    ledger.strike(5.1, 10.0, 30.0)
    assert (ledger.kept(5.1, 0), ledger.struck(5.1, 0)) == pytest.approx((10.0, 30.0))


def test_what_fits_beside_is_not_struck_off():
    """So the room that is given up counts as unused."""
    ledger = Ledger((1.0,))
    ledger.sent(5.0, (4.0,))
    ledger.strike(5.1, 10.0, 30.0)
    assert (ledger.kept(5.1, 0), ledger.last_struck) == (4.0, float("-inf"))


changes = st.lists(st.tuples(st.floats(0.01, 2.0), st.integers(0, 100)), max_size=12)


@given(changes, st.floats(0.0, 3.0))
def test_it_is_the_least_of_the_last_window(changes, later):
    """Compared with every value and when it held."""
    steady, now, spans = Steady(0.0, 50, 1.0), 0.0, [(0.0, 50)]
    for after, value in changes:
        now += after
        steady.set(now, value)
        spans.append((now, value))
    now += later
    ends = [start for start, _ in spans[1:]] + [float("inf")]
    assert steady.least(now) == min(v for (_, v), end in zip(spans, ends, strict=True) if end > now - 1.0)


def test_it_falls_at_once_and_rises_a_window_later():
    """A part that grows waits until what others sent before has left the window."""
    steady = Steady(0.0, 10, 2.0)
    steady.set(1.0, 30)
    assert (steady.least(2.9), steady.least(3.0)) == (10, 30)
    assert steady.rises_at(1.5) == 3.0
    steady.set(4.0, 5)
    assert steady.least(4.0) == 5
    assert steady.rises_at(6.0) == float("inf")


def test_room_that_was_unused_is_ours_sooner():
    """By as long as nobody used it, whatever other room came or went meanwhile."""
    steady = Steady(0.0, 10, 2.0)
    steady.set(5.0, 30, 1.5)
    assert (steady.least(5.4), steady.least(5.5)) == (10, 30)
    steady.set(5.2, 40, 99.0)
    assert (steady.least(5.4), steady.least(5.5)) == (20, 40)


def test_room_that_came_does_not_stand_in_for_room_that_went():
    """Ten are ours, and a slot of twenty; another slot comes, which is not ours yet when the first one goes."""
    steady = Steady(0.0, 30, 2.0)
    steady.set(5.0, 50)
    steady.give_up(5.5, 30, 20, 10)
    assert steady.least(5.5) == 10
    assert (steady.least(6.9), steady.least(7.0)) == (10, 30)
