"""Linear message utility."""

import math

import numpy as np
import pytest

from planner import Linear, ProblemError


def test_linear_values():
    """A linear utility falls from u0 by its slope and stops at zero."""
    assert Linear(2.0, 0.5).value(np.array([0.0, 1.0, 4.0, 9.0])).tolist() == [2.0, 1.5, 0.0, 0.0]
    assert Linear(2.0, 0.5).integral(np.array([0.0]), np.array([100.0])).tolist() == [4.0]


@pytest.mark.parametrize(
    ("build", "says"),
    [
        (lambda: Linear(-1.0, 1.0), "linear utility: u0 must be a finite number >= 0, not -1.0"),
        (lambda: Linear(math.nan, 1.0), "u0 must be .* not nan"),
        (lambda: Linear(1.0, 0.0), "linear utility: slope must be a finite number > 0, not 0.0"),
        (lambda: Linear(1.0, math.inf), "slope must be .* not inf"),
    ],
)
def test_parameters_without_meaning_are_refused(build, says):
    """The error names kind, parameter and value."""
    with pytest.raises(ProblemError, match=says):
        build()
