"""A value that falls with a power of age: that of a place which spreads as what was there moves on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

from planner.utility.base import Floats, Ints, require_above_zero, require_at_least_zero


@dataclass(frozen=True, slots=True)
class Polynomial:
    """`max(0, u0·(1 − (a / a1)^k))`: worth `u0` per second when fresh, nothing from the age `a1` [s] on.

    For the position of something that moves at some speed, k is the dimension of the space it moves in: the area
    (2), or the volume (3), that it may be in grows with that power of the age.
    """

    u0: float
    a1: float
    k: float = 2.0

    def __post_init__(self) -> None:
        require_at_least_zero("polynomial", "u0", self.u0)
        require_above_zero("polynomial", "a1", self.a1)
        require_above_zero("polynomial", "k", self.k)

    def value(self, age: Floats) -> Floats:
        """u(a) for every age [1/s]."""
        import numpy as np

        return np.where(age < 0, 0.0, self.u0 * (1.0 - (np.clip(age, 0.0, self.a1) / self.a1) ** self.k))

    def integral(self, start: Floats, end: Floats) -> Floats:
        """∫ u(a) da over [start, end] for every pair of ages, 0 <= start <= end [1]."""
        return _between(self.u0, self.a1, self.k, start, end)

    @classmethod
    def integrals(cls, utilities: Sequence[Self], which: Ints, start: Floats, end: Floats) -> Floats:
        """∫ of `utilities[which[j]]` over `[start[j], end[j]]` for every j [1]."""
        import numpy as np

        u0 = np.array([utility.u0 for utility in utilities])[which]
        a1 = np.array([utility.a1 for utility in utilities])[which]
        k = np.array([utility.k for utility in utilities])[which]
        return _between(u0, a1, k, start, end)


def _between(u0: Floats | float, a1: Floats | float, k: Floats | float, start: Floats, end: Floats) -> Floats:
    """∫ u(a) da over [start, end]; never below 0 by rounding."""
    import numpy as np

    return np.maximum(_area(u0, a1, k, end) - _area(u0, a1, k, start), 0.0)


def _area(u0: Floats | float, a1: Floats | float, k: Floats | float, age: Floats) -> Floats:
    """∫ u(a) da over [0, age]."""
    import numpy as np

    lived: Floats = np.minimum(age, a1)
    return u0 * lived * (1.0 - (lived / a1) ** k / (k + 1.0))
