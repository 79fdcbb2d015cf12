"""Power message utility."""

import math

import numpy as np
import pytest

from planner import Power, ProblemError


def test_the_first_seconds_are_worth_their_power():
    """The integral from 0 is exact, although the formula is infinite there."""
    utility = Power(0.5)
    assert utility.integral(np.zeros(3), np.array([0.0, 4.0, 9.0])).tolist() == [0.0, 2.0, 3.0]
    assert utility.value(np.array([0.25, 1.0, 4.0])).tolist() == [1.0, 0.5, 0.25]


@pytest.mark.parametrize("beta", [0.001, 0.5, 0.999])
def test_the_value_at_age_zero_is_finite_and_the_greatest(beta):
    """It is that at the least normal number."""
    values = Power(beta).value(np.array([0.0, 5e-324, 1e-300]))
    assert np.isfinite(values).all()
    assert values[0] == values[1] > values[2] > 0.0


@pytest.mark.parametrize(
    ("build", "says"),
    [
        (lambda: Power(0.0), "power utility: beta must be between 0 and 1, not 0.0"),
        (lambda: Power(1.0), "beta must be between 0 and 1, not 1.0"),
        (lambda: Power(math.nan), "beta must be between 0 and 1, not nan"),
    ],
)
def test_parameters_without_meaning_are_refused(build, says):
    """The error names kind, parameter and value."""
    with pytest.raises(ProblemError, match=says):
        build()
