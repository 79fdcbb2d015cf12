"""How long samples are worth anything."""

import math

import pytest

from planner import Exponential, Power, Step
from proxy.core.model.lifetimes import Lifetimes
from proxy.core.model.tuning import TUNING


def test_each_utility_has_its_lifetime():
    """A step ends at once, an exponential is worth half after a while, a power never ends."""
    lifetimes = Lifetimes()
    assert lifetimes.end(Step(1.0, 10.0)) == pytest.approx(10.0, rel=0.01)
    assert lifetimes.half_life(Step(1.0, 10.0)) == pytest.approx(10.0, rel=0.01)
    assert lifetimes.half_life(Exponential(2.0, 3.0)) == pytest.approx(3.0 * math.log(2.0), rel=0.01)
    assert lifetimes.end(Power(0.01)) == math.inf
    assert lifetimes.half_life(Step(1.0, 1e6)) == math.inf


def test_many_utilities_are_told_apart():
    """However many there were, and whichever are forgotten meanwhile."""
    lifetimes = Lifetimes()
    for k in range(2 * TUNING.utilities):
        assert lifetimes.end(Step(1.0, 1.0 + k)) == pytest.approx(1.0 + k, rel=0.01)
