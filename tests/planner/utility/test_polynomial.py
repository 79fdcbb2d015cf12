"""Polynomial message utility."""

import math

import numpy as np
import pytest

from planner import Linear, Polynomial, ProblemError


def test_values_fall_with_a_power_of_age():
    """In the plane half the age costs a quarter; nothing is left at a1."""
    utility = Polynomial(2.0, a1=4.0)
    assert utility.value(np.array([0.0, 2.0, 4.0, 9.0])).tolist() == [2.0, 1.5, 0.0, 0.0]
    assert utility.integral(np.array([0.0]), np.array([9.0])) == pytest.approx([2.0 * 4.0 * 2 / 3])


def test_the_first_power_is_linear():
    """Both kinds agree where they are the same function."""
    start = np.linspace(0.0, 6.0, 20)
    linear = Linear(2.0, 0.5).integral(start, start + 1.0)
    assert Polynomial(2.0, 4.0, k=1.0).integral(start, start + 1.0) == pytest.approx(linear)


@pytest.mark.parametrize(
    ("build", "says"),
    [
        (lambda: Polynomial(-1.0, 1.0), "polynomial utility: u0 must be a finite number >= 0, not -1.0"),
        (lambda: Polynomial(1.0, 0.0), "polynomial utility: a1 must be a finite number > 0, not 0.0"),
        (lambda: Polynomial(1.0, 1.0, 0.0), "polynomial utility: k must be a finite number > 0, not 0.0"),
        (lambda: Polynomial(1.0, 1.0, math.inf), "k must be .* not inf"),
    ],
)
def test_parameters_without_meaning_are_refused(build, says):
    """The error names kind, parameter and value."""
    with pytest.raises(ProblemError, match=says):
        build()
