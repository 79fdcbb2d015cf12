"""What is expected of a known pattern."""

from proxy.core.forecast.patterns import Memoryless, Periodic, Span, evenly, merged
from proxy.core.forecast.rhythm import Rhythm


def test_the_next_number_is_due_even_if_the_last_one_came_early():
    """A sample before its time is not expected once more."""
    early = Periodic(Rhythm(1.0, 10.0, 10, 0.1, 16))
    assert early.expect(Span(9.9, 9.9, 12.5, 9)) == [11.0, 12.0]
    assert (early.kind, early.period, early.jitter, early.pause) == ("periodic", 1.0, 0.1, 1.0)


def test_what_is_late_is_not_expected_any_more():
    """To keep room for it costs more than to be taken by surprise."""
    late = Periodic(Rhythm(1.0, 10.0, 10, 0.1, 16))
    assert late.expect(Span(11.1, 11.1, 12.0, 9)) == [12.0]
    assert late.expect(Span(11.0, 11.0, 12.0, 9)) == [12.0]


def test_periods_that_times_cannot_tell_apart_end_all_the_same():
    """Nobody waits for a number that is due later."""
    assert len(Periodic(Rhythm(1e-30, 100.1, 10, 0.0, 16)).expect(Span(100.3, 100.3, 160.3, 9))) == 9


def test_random_samples_come_from_now_on():
    """Not from when the last one was heard of."""
    pattern = Memoryless(2.0)
    assert pattern.expect(Span(10.0, 4.0, 15.0, 9)) == [12.0, 14.0]
    assert (pattern.kind, pattern.period, pattern.jitter, pattern.pause) == ("poisson", 2.0, 2.0, 2.0)


def test_times_are_bounded():
    """By number, by the end, and by what was asked for."""
    assert evenly(1.0, 0.5, 2.0, 9) == [1.0, 1.5, 2.0]
    assert evenly(1.0, 0.5, 2.0, 2) == [1.0, 1.5]
    assert evenly(3.0, 0.5, 2.0, 2) == []
    assert merged([[3.0, 5.0], [1.0, 4.0, 9.0]], Span(2.0, 2.0, 6.0, 2)) == [3.0, 4.0]
