"""A value drawn by hand: straight lines through given points."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Self

from planner.errors import ProblemError
from planner.finite import finite
from planner.utility.base import Floats, Ints, told_apart
from planner.utility.piecewise import PiecewiseLinear


@dataclass(frozen=True, slots=True)
class Table:
    """Straight lines through `points` of (age [s], value [1/s]).

    The first value holds from age 0 to the first age, the last value from the last age on, for ever: end with a
    value of 0 unless a message shall never lose its worth.
    """

    points: tuple[tuple[float, float], ...]
    curve: PiecewiseLinear = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        import numpy as np

        if not self.points:
            raise ProblemError("table utility: points must hold at least one (age, value)")
        for age, value in self.points:
            if not (finite(age) and age >= 0):
                raise ProblemError(f"table utility: points must have finite ages >= 0, not {age}")
            if not (finite(value) and value >= 0):
                raise ProblemError(f"table utility: points must have finite values >= 0, not {value}")
        for (before, _), (after, _) in pairwise(self.points):
            if after <= before:
                raise ProblemError(f"table utility: points must have rising ages, not {after} after {before}")
        ages, values = np.array(self.points, dtype=np.float64).T.copy()
        curve = PiecewiseLinear.through(ages, values)
        if not curve.finite:
            raise ProblemError("table utility: points are too close to each other or too large for a finite integral")
        object.__setattr__(self, "curve", curve)

    def value(self, age: Floats) -> Floats:
        """u(a) for every age [1/s]."""
        return self.curve.value(age)

    def integral(self, start: Floats, end: Floats) -> Floats:
        """∫ u(a) da over [start, end] for every pair of ages, 0 <= start <= end [1]."""
        return _between(self.curve, start, end)

    @classmethod
    def integrals(cls, utilities: Sequence[Self], which: Ints, start: Floats, end: Floats) -> Floats:
        """∫ of `utilities[which[j]]` over `[start[j], end[j]]` for every j [1].

        The points of all tables stand in one row and are found by table and age, as the real and the imaginary
        part of a complex number: NumPy sorts these by both.
        """
        import numpy as np

        curves, number = told_apart([utility.curve for utility in utilities])
        of = number[which]
        if len(curves) == 1:
            return _between(curves[0], start, end)
        row = PiecewiseLinear.row(curves)
        places = np.repeat(np.arange(len(curves)), [len(curve.ages) for curve in curves]) + 1j * row.ages
        begin, until = (places.searchsorted(of + 1j * age, side="right") - 1 for age in (start, end))
        return np.maximum(row.area(until, end) - row.area(begin, start), 0.0)


def _between(curve: PiecewiseLinear, start: Floats, end: Floats) -> Floats:
    """∫ u(a) da over [start, end]; never below 0 by rounding."""
    import numpy as np

    begin, until = (curve.ages.searchsorted(age, side="right") - 1 for age in (start, end))
    return np.maximum(curve.area(until, end) - curve.area(begin, start), 0.0)
