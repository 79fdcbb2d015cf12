"""Period and phase on the circle."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.schedule import Schedule


def observed(period, phase, count, jitter=0.0, seed=0):
    rng = np.random.default_rng(seed)
    schedule = Schedule()
    for k in range(count):
        schedule.observe(k + 1, phase + k * period + rng.normal(0.0, jitter) * period)
    return schedule


@given(st.floats(0.01, 60.0), st.floats(0.0, 1000.0), st.integers(3, 40))
def test_a_steady_stream_is_predicted_exactly(period, phase, count):
    """Without jitter the next generation times are those of the stream."""
    schedule = observed(period, phase, count)
    last = phase + (count - 1) * period
    expected = [last + period, last + 2 * period]
    assert schedule.forecast(last, last + 2.5 * period, 10) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("phase", [0.0, 0.001, 0.5, 0.999])
def test_the_phase_is_right_even_where_it_lies_near_zero(phase):
    """Jitter around a phase of 0 does not predict half a period wrong: the mean is taken on the circle."""
    schedule = observed(1.0, phase, 40, jitter=0.1, seed=3)
    predicted = schedule.forecast(40.0 + phase - 0.5, 40.0 + phase + 0.5, 3)
    assert len(predicted) == 1
    assert abs(predicted[0] - (40.0 + phase)) < 0.15


def test_samples_that_were_not_seen_do_not_stretch_the_period():
    """The period comes from counts, so a gap of three samples spans three periods."""
    schedule = Schedule()
    for count in (1, 2, 5, 6, 9, 10):
        schedule.observe(count, 0.2 * count)
    assert schedule.period == pytest.approx(0.2)


def test_one_sample_predicts_nothing():
    """A period is not invented from a single generation time."""
    schedule = Schedule()
    assert schedule.forecast(0.0, 10.0, 5) == []
    schedule.observe(1, 1.0)
    assert schedule.forecast(1.0, 10.0, 5) == []


def test_a_period_told_by_another_robot_serves_until_one_is_seen():
    """An assumed period is used at once and replaced by the estimate."""
    schedule = Schedule()
    schedule.observe(1, 1.0)
    for nonsense in (0.0, -1.0, math.nan, math.inf):
        schedule.assume(nonsense)
    assert schedule.period == 0.0
    schedule.assume(0.5)
    assert schedule.forecast(1.0, 2.1, 5) == pytest.approx([1.5, 2.0])
    for count in (2, 3, 4):
        schedule.observe(count, 1.0 + 0.4 * (count - 1))
    assert schedule.period == pytest.approx(0.4)


def test_old_news_changes_nothing():
    """Counts and times only go forward."""
    schedule = observed(1.0, 0.0, 5)
    before = schedule.forecast(4.0, 8.0, 5)
    schedule.observe(3, 2.5)
    schedule.observe(6, 1.0)
    assert schedule.forecast(4.0, 8.0, 5) == before


@given(st.integers(0, 5))
def test_a_forecast_is_bounded(most):
    """No more than the asked number of times comes back, in order, within the interval."""
    times = observed(0.1, 0.0, 10).forecast(0.9, 3.0, most)
    assert len(times) == most
    assert times == sorted(times)
    assert all(0.9 < t <= 3.0 for t in times)
