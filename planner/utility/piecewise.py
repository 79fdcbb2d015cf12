"""Piecewise linear functions and their integrals: what `Table` and `Custom` are made of."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

from planner.utility.base import Floats, Ints


@dataclass(frozen=True, slots=True, eq=False)
class PiecewiseLinear:
    """A function through points, the first of them at age 0; its last value holds from the last age on.

    `points` has four rows: the ages [s], the values there [1/s], the slopes after them [1/s²], 0 after the last,
    and the integrals from age 0 up to them [1].
    """

    points: Floats

    @classmethod
    def through(cls, ages: Floats, values: Floats) -> Self:
        """Return the function through points of rising ages >= 0 [s]; the first value holds before the first age.

        What is too large for floating-point numbers comes out as not finite.
        """
        import numpy as np

        if ages[0] > 0.0:
            ages, values = np.append(0.0, ages), np.append(values[:1], values)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            widths = np.diff(ages)
            slopes = np.append(np.diff(values) / widths, 0.0)
            areas = np.append(0.0, np.cumsum(widths * (0.5 * values[:-1] + 0.5 * values[1:])))
        return cls(np.stack((ages, values, slopes, areas)))

    @classmethod
    def row(cls, functions: Sequence[Self]) -> Self:
        """Return the points of all functions one after the other: not a function, but `area` works on it."""
        import numpy as np

        return cls(np.concatenate([function.points for function in functions], axis=1))

    @property
    def ages(self) -> Floats:
        """The ages of the points [s]."""
        ages: Floats = self.points[0]
        return ages

    @property
    def finite(self) -> bool:
        """Whether all slopes and areas are finite."""
        import numpy as np

        return bool(np.isfinite(self.points).all())

    def value(self, age: Floats) -> Floats:
        """The function at every age; 0 before the age 0 [1/s]."""
        import numpy as np

        ages, values, _, _ = self.points
        return np.where(age < 0, 0.0, np.maximum(np.interp(age, ages, values), 0.0))

    def area(self, point: Ints, age: Floats) -> Floats:
        """∫ over [0, age], where `point` is the number of the last point that is not after `age` [1]."""
        since, value, slope, area = self.points.take(point, axis=1)
        gone = age - since
        total: Floats = area + gone * (value + 0.5 * gone * slope)
        return total
