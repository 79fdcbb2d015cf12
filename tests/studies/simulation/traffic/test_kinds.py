"""Kinds of samples."""

from dataclasses import replace

import numpy as np
import pytest

from planner import Linear
from studies.simulation.missions import specs_of
from studies.simulation.traffic.kinds import PAUSES, START, Kind


def random():
    return np.random.default_rng(7)


def test_samples_come_with_a_period_or_at_random():
    """From a start within the first second on, in order, as often as the rate says."""
    periodic = Kind("a", Linear(1.0, 1.0), (20, 20), (100, 100)).times(random(), 30.0)
    assert 0.0 <= periodic[0] <= START + 0.01
    assert np.diff(periodic) == pytest.approx(0.05, abs=0.02)
    assert periodic[-1] < 30.0
    drawn = Kind("a", Linear(1.0, 1.0), (20, 20), (100, 100), at_random=True).times(random(), 100.0)
    gaps = np.diff(drawn)
    assert gaps.min() >= 0.0
    assert gaps.mean() == pytest.approx(0.05, rel=0.1)
    assert gaps.std() == pytest.approx(0.05, rel=0.15)


def test_rates_and_typical_sizes_differ_by_stream():
    """Both lie within their bounds."""
    kind, draw = Kind("a", Linear(1.0, 1.0), (0.2, 10.0), (100.0, 4_000.0)), random()
    counts = [len(kind.times(draw, 100.0)) for _ in range(50)]
    assert 15 <= min(counts) < 100 < max(counts) <= 1000
    typical = [np.median(kind.draw_sizes(draw, 50)) for _ in range(50)]
    assert 90 <= min(typical) < 500 < max(typical) <= 4_400


def test_sizes_vary_from_sample_to_sample():
    """Around the typical one, or all over."""
    around = Kind("a", Linear(1.0, 1.0), (1, 1), (1000, 1000), spread=0.1).draw_sizes(random(), 1000)
    assert around.std() == pytest.approx(100.0, rel=0.1)
    anew = Kind("a", Linear(1.0, 1.0), (1, 1), (1000, 4000), anew=True).draw_sizes(random(), 1000)
    assert 1000 <= anew.min() < 1100
    assert 3900 < anew.max() <= 4000
    assert list(anew) == [int(size) for size in anew]


def test_some_streams_pause():
    """They publish as before, but for pauses of some seconds; the others are as they were."""
    kind, seeds = Kind("a", Linear(1.0, 1.0), (20, 20), (100, 100)), range(60)
    pausing = replace(kind, pausing=0.5)
    always, now_and_then = ([each.times(np.random.default_rng(s), 100.0) for s in seeds] for each in (kind, pausing))
    paused = [(all_, some) for all_, some in zip(always, now_and_then, strict=True) if len(some) < len(all_)]
    assert 15 <= len(paused) <= 45
    for all_, some in paused:
        assert set(some) < set(all_)
        begins = np.flatnonzero(np.diff(some) > 1.0)
        assert len(begins) >= 2
        assert ((PAUSES[0] <= np.diff(some)[begins]) & (np.diff(some)[begins] <= PAUSES[1] + 0.1)).all()
        between = np.diff(some[begins])
        assert ((2 * PAUSES[0] <= between) & (between <= 2 * PAUSES[1] + 0.1)).all()


def test_a_kind_is_written_as_a_spec():
    """A daemon reads what the kind says."""
    kind = Kind("view", Linear(1.0, 0.5), (1, 1), (9, 9), weight=3.0, aggregation="best", red=True)
    found = specs_of(kind.spec()).match("r7/view")
    assert (found.name, found.utility, found.aggregation) == ("view", Linear(1.0, 0.5), "best")
    assert found.scale({"red": 0.5}) == 3.0 * 6.0
