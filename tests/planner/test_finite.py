"""What counts as a finite number."""

import math
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

from planner.finite import finite


@pytest.mark.parametrize("number", [0, -1, 2.5, 1e308, True, Fraction(1, 3), np.float32(1.0), np.int64(7)])
def test_numbers_are_finite(number):
    """Every real number that floating point can hold counts."""
    assert finite(number)


@pytest.mark.parametrize("other", [math.nan, math.inf, 10**400, "1.5", None, 1j, Decimal(1), [1.0], np.array([1.0])])
def test_all_else_is_not(other):
    """Text is no number, and what overflows is not finite; nothing raises."""
    assert not finite(other)
