"""What was ours throughout a window: it falls at once and rises one window later."""

from hypothesis import given
from hypothesis import strategies as st

from proxy.core.split.own_part import Steady

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
