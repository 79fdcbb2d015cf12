"""Periods and phases by robust straight lines."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.forecast.rhythm import Rhythm, fit
from tests.proxy.core.streams import periodic


@given(
    st.floats(1e-3, 1e3),
    st.floats(-1e4, 1e4),
    st.lists(st.integers(1, 9), min_size=2, max_size=20),
)
def test_a_grid_is_found_exactly(period, start, steps):
    """Whatever numbers are missing."""
    number, points = 0, []
    for step in steps:
        number += step
        points.append((number, start + number * period))
    rhythm = fit(points)
    assert rhythm.period == pytest.approx(period, rel=1e-6)
    assert rhythm.due(number + 1) == pytest.approx(start + (number + 1) * period, rel=1e-6, abs=1e-6 * period)
    assert rhythm.looseness < 1e-3
    assert rhythm.known == len(points)


def test_nothing_is_made_of_less_than_two_times():
    """Unless a period is told."""
    assert fit([]) is None
    assert fit([(1, 2.0)]) is None
    assert fit([(1, 2.0)], 0.5) == Rhythm(0.5, 2.0, 1, 0.0, 1)


@pytest.mark.parametrize("wrong", [3, 8, 14])
def test_a_time_that_is_far_off_counts_nothing(wrong):
    """The line goes through the others."""
    points = list(enumerate(periodic(16)))
    points[wrong] = (wrong, points[wrong][1] + 0.45)
    rhythm = fit(points)
    assert (rhythm.period, rhythm.due(16)) == (pytest.approx(1.0), pytest.approx(21.0))


def test_a_told_period_is_kept():
    """Only the phase is found."""
    rhythm = fit([(0, 0.0), (1, 1.1), (2, 2.2)], 1.0)
    assert (rhythm.period, rhythm.due(3)) == (1.0, pytest.approx(3.1))


def test_deviations_that_add_up_are_told_from_those_that_do_not():
    """Then the last time tells the next."""
    times = [0.0, 1.0, 2.1, 3.3, 4.5, 5.6, 6.6, 7.5, 8.3, 9.0, 9.7, 10.5, 11.4, 12.5, 13.6, 14.7]
    rhythm = fit(list(enumerate(times)))
    assert rhythm.wanders
    assert rhythm.origin == pytest.approx(14.7)
    assert not fit(list(enumerate(periodic(16, jitter=0.1, seed=5)))).wanders


def test_one_more_sample_moves_a_rhythm_as_far_as_a_fit_would():
    """A sixteenth of a sample's weight on the period, a quarter on the phase."""
    points = list(enumerate(periodic(16, jitter=0.02, seed=7)))
    nudged, whole = fit(points[:15]).nudged(*points[15]), fit(points)
    assert nudged.period == pytest.approx(whole.period, abs=0.003)
    assert nudged.due(16) == pytest.approx(whole.due(16), abs=0.01)
    sparse = [(20 * n, 20 * t) for n, t in points]
    nudged, whole = fit(sparse[:15]).nudged(*sparse[15], 20.0), fit(sparse)
    assert nudged.period == pytest.approx(whole.period, abs=0.003)
    assert fit([(0, 0.0), (1, 1.0)]).nudged(2, 2.0).due(3) == pytest.approx(3.0)
    assert Rhythm(1.0, 5.0, 5, 0.1, 16, wanders=True).nudged(6, 6.2).origin == 6.2


def test_there_is_no_period_that_is_none():
    """Times that stand still or fall tell none."""
    assert fit([(0, 1.0), (1, 1.0)]) is None
    assert fit([(0, 2.0), (1, 1.0), (2, 0.0)]) is None


def test_the_longer_ago_a_rhythm_was_found_and_from_the_fewer_samples_the_less_sure_it_is():
    """As far as a line through so many times, each off by the jitter, is known: its end best, by sampling."""
    random = np.random.default_rng(7)
    for known, ahead in ((8, 1), (8, 30), (48, 30)):
        times = np.arange(known) + random.normal(0.0, 0.01, (4000, known))
        off = [
            np.polyval(np.polyfit(np.arange(known), each, 1), known - 1 + ahead) - known + 1 - ahead for each in times
        ]
        rhythm = Rhythm(1.0, 0.0, known, 0.01, known)
        assert rhythm.uncertainty(ahead) == pytest.approx(np.hypot(np.std(off), 0.01), rel=0.1)


def test_a_few_samples_that_happen_to_be_on_a_line_are_no_reason_to_be_sure():
    """Two always are: one of two robots that began took the other's next sample for sent 10 ms before it came."""
    assert Rhythm(1.0, 0.0, 2, 0.0, 4).uncertainty(0.0) >= 0.02
    assert Rhythm(1.0, 0.0, 2, 0.3, 4).uncertainty(0.0) >= 0.3
    assert Rhythm(1.0, 0.0, 8, 0.0, 8).uncertainty(0.0) == 0.0
