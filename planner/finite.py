"""What counts as a number: text that looks like one does not."""

import math
from numbers import Real


def finite(value: object) -> bool:
    """Whether `value` is a finite number that floating point can hold."""
    try:
        return isinstance(value, Real) and math.isfinite(value)
    except OverflowError:  # a whole number of hundreds of digits
        return False
