"""What kinds of message utility share."""

import math

import pytest

from planner import ProblemError
from planner.utility.base import require_above_zero, require_at_least_zero, told_apart


def test_objects_are_told_apart_by_identity():
    """Each is returned once, in order, and every place says which it holds."""
    a, b = [1], [1]
    distinct, of = told_apart([a, b, a])
    assert distinct[0] is a
    assert distinct[1] is b
    assert len(distinct) == 2
    assert of.tolist() == [0, 1, 0]


@pytest.mark.parametrize("value", [-1.0, math.nan, math.inf])
def test_a_parameter_out_of_range_is_named_with_kind_and_value(value):
    """Both checks refuse it; 0 only where it must be more."""
    require_at_least_zero("k", "p", 0.0)
    require_above_zero("k", "p", 1e-9)
    with pytest.raises(ProblemError, match=f"k utility: p must be a finite number >= 0, not {value}"):
        require_at_least_zero("k", "p", value)
    with pytest.raises(ProblemError, match=f"k utility: p must be a finite number > 0, not {value}"):
        require_above_zero("k", "p", value)
    with pytest.raises(ProblemError, match="not 0"):
        require_above_zero("k", "p", 0.0)
