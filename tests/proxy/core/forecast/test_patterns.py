"""What is expected of a known pattern: bursts, and schedules that specs write over what was seen."""

import pytest

from proxy.core.forecast.patterns import Memoryless, Periodic, Span, bursts_in, evenly, merged, reported_bursts
from proxy.core.forecast.recognition import written
from proxy.core.forecast.rhythm import Rhythm
from tests.proxy.core.streams import bursts, periodic, poisson
from utility_specs.schedules import PeriodicRule, PoissonRule, PythonRule, TimesRule
from utility_specs.specs import Failures


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
    assert (pattern.kind, pattern.period, pattern.jitter, pattern.pause) == ("poisson", 2.0, 2.0, 6.0)


@pytest.mark.parametrize("until", [9.0, 10.0, 10.9, 11.0, 13.5])
@pytest.mark.parametrize("at_last", [9.5, 11.0, 12.0, 60.0])
def test_where_nothing_comes_in_time_the_next_sample_alone_is_expected(until, at_last):
    """As if one asked twice, whatever the pattern."""
    patterns = Periodic(Rhythm(1.5, 9.5, 10, 0.1, 16)), Memoryless(2.0), bursts_in(numbered(bursts(4)), whole=True)
    for pattern in patterns:
        span = Span(9.6, 9.2, until, 9)
        once = pattern.expect(span) or pattern.expect(Span(9.6, 9.2, at_last, 1))
        assert pattern.ahead(span, at_last) == once


def test_times_are_bounded():
    """By number, by the end, and by what was asked for."""
    assert evenly(1.0, 0.5, 2.0, 9) == [1.0, 1.5, 2.0]
    assert evenly(1.0, 0.5, 2.0, 2) == [1.0, 1.5]
    assert evenly(3.0, 0.5, 2.0, 2) == []
    assert merged([[3.0, 5.0], [1.0, 4.0, 9.0]], Span(2.0, 2.0, 6.0, 2)) == [3.0, 4.0]


def numbered(times):
    return list(enumerate(times, 1))


def test_bursts_are_found_by_their_pauses():
    """Size, step and spacing are those of the stream."""
    found = bursts_in(numbered(bursts(8, size=4, step=0.1, spacing=3.0)), whole=True)
    assert (found.size, found.step, found.begun) == (4, pytest.approx(0.1), 4)
    assert (found.pause, found.period, found.jitter) == (pytest.approx(3.0), pytest.approx(0.75), pytest.approx(0.0))
    assert found.kind == "bursts 4 0.1"


def test_a_burst_goes_on():
    """With a sample that comes soon; one that comes late begins another."""
    found = bursts_in(numbered([*bursts(4), 8.0]), whole=True)
    assert found.joined(8.05).expect(Span(8.05, 8.05, 9.0, 9)) == pytest.approx([8.1, 8.15, 8.2])
    assert found.joined(8.3) is None


def test_two_bursts_and_a_begun_one_are_enough():
    """If they are alike."""
    assert bursts_in(numbered([*bursts(2), 4.0]), whole=True).begun == 1
    assert bursts_in(numbered([0.0, 0.1, 2.0, 2.1, 2.2, 2.3, 2.4, 2.5, 4.0, 4.1]), whole=True) is None


def test_the_first_burst_may_have_begun_before_what_is_remembered():
    """Then it tells nothing of the size."""
    assert bursts_in(numbered(bursts(6, size=6)[4:]), whole=False).size == 6


@pytest.mark.parametrize("times", [periodic(48, jitter=0.1), poisson(48, seed=1), [1.0, 2.0], [*periodic(20), 99.0]])
def test_not_every_pause_ends_a_burst(times):
    """Jitter, chance, and a single pause make none."""
    assert bursts_in(numbered(times), whole=True) is None


def test_of_reported_bursts_the_last_sample_ends_one():
    """Size and step come as words; nonsense is none."""
    told = reported_bursts(["bursts", "3", "0.1"], 1.0, 10.0)
    assert told.expect(Span(10.0, 10.0, 13.05, 9)) == pytest.approx([12.8, 12.9, 13.0])
    for nonsense in ("bursts", "bursts 3", "bursts 1 0.1", "bursts 3 nan", "bursts 3 2", "bursts x 1", "bursts 1e9 1"):
        assert reported_bursts(nonsense.split(), 1.0, 10.0) is None


PAST = [(1, 10.0), (2, 11.0), (3, 12.0)]


@pytest.mark.parametrize(
    ("rule", "kind", "period", "pause", "expected"),
    [
        (PeriodicRule(1.5), "periodic", 1.5, 1.5, [13.5, 15.0]),
        (PeriodicRule(1.5, 0.5), "periodic", 1.5, 1.5, [13.5, 15.0]),
        (PoissonRule(1.5), "poisson", 1.5, 4.5, [13.5, 15.0]),
        (TimesRule((0.0, 1.0), 2.0), "times", 1.0, 1.0, [13.0, 14.0, 15.0]),
        (TimesRule((7.0,)), "times", 0.0, 0.0, []),
        (PythonRule("x:y", lambda times, _: [times[-1] + 2.5]), "python", 9.0, 9.0, [14.5]),
    ],
)
def test_each_rule_says_when(rule, kind, period, pause, expected):
    """From what was seen comes only where it begins."""
    pattern = written(rule, PAST, 9.0, Failures())
    assert (pattern.kind, pattern.period, pattern.pause) == (kind, period, pause)
    found = pattern.expect(Span(12.0, 12.0, 15.0, 9))
    assert found == pytest.approx(expected)
    assert len(pattern.expect(Span(12.0, 12.0, 15.0, 1))) <= 1
