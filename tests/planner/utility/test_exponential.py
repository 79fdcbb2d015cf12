"""Exponential message utility."""

import math

import numpy as np
import pytest

from planner import Exponential, ProblemError


def test_a_time_constant_costs_63_percent():
    """The value falls by the same factor with every tau, and all of it adds up to u0·tau."""
    utility = Exponential(2.0, tau=3.0)
    assert utility.value(np.array([0.0, 3.0, 6.0])) == pytest.approx([2.0, 2.0 / math.e, 2.0 / math.e**2])
    assert utility.integral(np.array([0.0, 3.0]), np.array([1e4, 1e4])) == pytest.approx([6.0, 6.0 / math.e])


def test_short_intervals_at_great_age_keep_their_digits():
    """The integral does not subtract two numbers that are nearly equal."""
    start = np.array([30.0])
    assert Exponential(1.0, 1.0).integral(start, start + 1e-9) == pytest.approx(1e-9 * math.exp(-30.0), rel=1e-5)


@pytest.mark.parametrize(
    ("build", "says"),
    [
        (lambda: Exponential(-1.0, 1.0), "exponential utility: u0 must be a finite number >= 0, not -1.0"),
        (lambda: Exponential(1.0, 0.0), "exponential utility: tau must be a finite number > 0, not 0.0"),
        (lambda: Exponential(1.0, math.nan), "tau must be .* not nan"),
    ],
)
def test_parameters_without_meaning_are_refused(build, says):
    """The error names kind, parameter and value."""
    with pytest.raises(ProblemError, match=says):
        build()
