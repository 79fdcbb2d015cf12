"""How long samples are worth anything."""

import math

import pytest

from planner import Exponential, Power, Step
from proxy.core.model.lifetimes import half_life, worthless_from


def test_each_utility_has_its_lifetime():
    """A step ends at once, an exponential is worth half after a while, a power never ends."""
    assert worthless_from(Step(1.0, 10.0)) == pytest.approx(10.0, rel=0.01)
    assert half_life(Step(1.0, 10.0)) == pytest.approx(10.0, rel=0.01)
    assert half_life(Exponential(2.0, 3.0)) == pytest.approx(3.0 * math.log(2.0), rel=0.01)
    assert worthless_from(Power(0.01)) == math.inf
    assert half_life(Step(1.0, 1e6)) == math.inf
