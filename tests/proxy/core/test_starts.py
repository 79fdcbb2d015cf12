"""Streams that begin irregularly: a publisher that catches up once it is connected, a first gap that is a pause."""

import math
from itertools import accumulate

import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.forecast.schedule import Schedule
from tests.proxy.core.streams import observe, periodic

FORGOTTEN = 50
"""After so many regular samples nothing that was before them counts."""
LATE = 3
"""A stream may be taken for over before so many samples of another rate."""


@pytest.mark.parametrize("close", [2, 3])
def test_two_or_three_first_samples_close_together_do_not_make_pauses_of_all_gaps(close):
    """From the second regular sample on the stream is there between samples, with the right period."""
    start = [0.001 * k for k in range(close)]
    schedule = observe(Schedule(), [*start, 0.1, 0.2])
    assert not schedule.over(0.3)
    assert schedule.forecast(0.2, 0.45, 5) == pytest.approx([0.3, 0.4], abs=1e-3)


@pytest.mark.parametrize("close", [4, 10, 50, 500])
def test_pauses_in_a_row_are_the_gaps_of_another_rate(close):
    """However many samples came at once before, the third regular one tells the rate."""
    start = [0.001 * k for k in range(close)]
    schedule = observe(Schedule(), [*start, *[start[-1] + 0.1 * k for k in range(1, 4)]])
    last = start[-1] + 0.3
    assert not schedule.over(last + 0.1)
    assert schedule.forecast(last, last + 0.25, 5) == pytest.approx([last + 0.1, last + 0.2], abs=1e-3)


@pytest.mark.parametrize("period", [0.02, 0.1, 1.0, 7.0, 60.0])
@given(gaps=st.lists(st.floats(-5.0, 2.5), min_size=1, max_size=60))
def test_however_a_stream_began_it_is_known_in_the_end(period, gaps):
    """Gaps of up to 300 periods and down to none at all; nor is it over meanwhile, but for the first few samples."""
    start = list(accumulate((period * 10.0**gap for gap in gaps), initial=0.0))
    schedule = observe(Schedule(), start)
    for k in range(1, FORGOTTEN + 1):
        t = start[-1] + k * period
        assert k <= LATE or not schedule.over(t)
        schedule.observe(len(start) + k, t)
    expected = [t + period, t + 2 * period]
    assert schedule.forecast(t, t + 2.5 * period, 10) == pytest.approx(expected, abs=0.05 * period)


def test_bursts_that_do_not_end_are_none_any_more():
    """A stream of a few bursts that goes on at the rate within them is regular."""
    start = [10.0 * burst + 0.1 * k for burst in range(4) for k in range(3)]
    schedule = observe(Schedule(), [*start, *[30.2 + 0.1 * k for k in range(1, 13)]])
    assert schedule.kind == "periodic"


def test_samples_of_one_moment_have_no_rhythm():
    """Times as close together as numbers can be say nothing of those to come."""
    schedule = observe(Schedule(), [1e5, math.nextafter(1e5, math.inf)])
    assert schedule.forecast(1e5, 1e5 + 1.0, 10) == []
    assert schedule.period == 0.0


@pytest.mark.parametrize(("period", "kind"), [(1e-300, "periodic"), (1e-300, "poisson"), (1.0, "bursts 2 1e-320")])
def test_a_period_that_cannot_be_told_in_earnest_stops_nothing(period, kind):
    """Whatever another robot's state says of its streams, forecasts come, and are bounded."""
    schedule = observe(Schedule(), periodic(20))
    schedule.assume(period, kind)
    times = schedule.forecast(25.0, 30.0, 7)
    assert len(times) <= 7
    assert all(25.0 < t <= 30.0 for t in times)
