"""Windows over a limit."""

import numpy as np

from studies.replay.violations import violating
from tests.studies.replay.traffic import POSE, entered, mission, samples, spec


def over(told, text=None, fates=None):
    outcomes = entered(mission(text), told, fates)
    return np.flatnonzero(violating(outcomes, outcomes.columns())).tolist()


def test_the_sample_that_ends_a_window_over_the_limit_is_counted():
    """1,000 bytes fit into a closed second."""
    assert over(samples(seconds=3, period=1.0, size=500)) == []
    assert over(samples(seconds=3, period=1.0, size=501)) == [1, 2]
    assert over(samples(seconds=3, period=0.5, size=500)) == [2, 3, 4, 5]
    assert over(samples(seconds=3, period=0.5, size=500), fates=lambda n: n % 2 == 0) == []


def test_one_that_is_too_large_needs_a_longer_window_for_itself():
    """Of 2,000 bytes one in 2 s is right."""
    assert over(samples(seconds=9, period=3.0, size=2000)) == []
    assert over(samples(seconds=6, period=2.0, size=2000)) == [1, 2]


def test_what_nobody_decides_on_breaks_nothing_itself():
    """But others must leave room for it."""
    told = sorted([*samples(3, 1.0, 900), *samples(3, 1.0, 200, key="r1/pose", start=100.1)], key=lambda each: each.t)
    assert over(told, spec()) == [2, 4]
    assert over(told, spec() + POSE) == [1, 2, 3, 4, 5]
