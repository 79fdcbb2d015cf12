"""A value that falls linearly with age: the utility of the paper's simulation study (§4.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

from planner.utility.base import Floats, Ints, require_above_zero, require_at_least_zero


@dataclass(frozen=True, slots=True)
class Linear:
    """`max(0, u0 − slope·a)`: worth `u0` per second when fresh, nothing from the age `u0 / slope` [s] on."""

    u0: float
    slope: float

    def __post_init__(self) -> None:
        require_at_least_zero("linear", "u0", self.u0)
        require_above_zero("linear", "slope", self.slope)

    def value(self, age: Floats) -> Floats:
        """u(a) for every age [1/s]."""
        import numpy as np

        return np.where(age < 0, 0.0, np.maximum(0.0, self.u0 - self.slope * age))

    def integral(self, start: Floats, end: Floats) -> Floats:
        """∫ u(a) da over [start, end] for every pair of ages, 0 <= start <= end [1]."""
        return _linear_area(self.u0, self.slope, end) - _linear_area(self.u0, self.slope, start)

    @classmethod
    def integrals(cls, utilities: Sequence[Self], which: Ints, start: Floats, end: Floats) -> Floats:
        """∫ of `utilities[which[j]]` over `[start[j], end[j]]` for every j [1]."""
        import numpy as np

        u0 = np.array([utility.u0 for utility in utilities])[which]
        slope = np.array([utility.slope for utility in utilities])[which]
        return _linear_area(u0, slope, end) - _linear_area(u0, slope, start)


def _linear_area(u0: Floats | float, slope: Floats | float, age: Floats) -> Floats:
    """∫ u(a) da over [0, age]."""
    import numpy as np

    lived: Floats = np.minimum(age, u0 / slope)
    return lived * (u0 - 0.5 * slope * lived)
