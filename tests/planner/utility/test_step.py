"""Step message utility."""

import math

import numpy as np
import pytest

from planner import ProblemError, Step


def test_a_message_is_worth_the_same_until_its_lifetime_is_over():
    """At the age of its lifetime it is worth nothing any more."""
    utility = Step(2.0, lifetime=0.5)
    assert utility.value(np.array([0.0, 0.4, 0.5, 1.0])).tolist() == [2.0, 2.0, 0.0, 0.0]
    assert utility.integral(np.array([0.0, 0.25, 0.6]), np.array([9.0, 0.5, 0.9])).tolist() == [1.0, 0.5, 0.0]


@pytest.mark.parametrize(
    ("build", "says"),
    [
        (lambda: Step(math.inf, 1.0), "step utility: u0 must be a finite number >= 0, not inf"),
        (lambda: Step(1.0, 0.0), "step utility: lifetime must be a finite number > 0, not 0.0"),
    ],
)
def test_parameters_without_meaning_are_refused(build, says):
    """The error names kind, parameter and value."""
    with pytest.raises(ProblemError, match=says):
        build()
