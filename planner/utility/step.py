"""A value that lasts for a while and then is gone: that of a command, or a warning."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

from planner.utility.base import Floats, Ints, require_above_zero, require_at_least_zero


@dataclass(frozen=True, slots=True)
class Step:
    """`u0` per second while the age is less than `lifetime` [s], then nothing."""

    u0: float
    lifetime: float

    def __post_init__(self) -> None:
        require_at_least_zero("step", "u0", self.u0)
        require_above_zero("step", "lifetime", self.lifetime)

    def value(self, age: Floats) -> Floats:
        """u(a) for every age [1/s]."""
        import numpy as np

        return np.where((age >= 0) & (age < self.lifetime), self.u0, 0.0)

    def integral(self, start: Floats, end: Floats) -> Floats:
        """∫ u(a) da over [start, end] for every pair of ages, 0 <= start <= end [1]."""
        return _between(self.u0, self.lifetime, start, end)

    @classmethod
    def integrals(cls, utilities: Sequence[Self], which: Ints, start: Floats, end: Floats) -> Floats:
        """∫ of `utilities[which[j]]` over `[start[j], end[j]]` for every j [1]."""
        import numpy as np

        u0 = np.array([utility.u0 for utility in utilities])[which]
        lifetime = np.array([utility.lifetime for utility in utilities])[which]
        return _between(u0, lifetime, start, end)


def _between(u0: Floats | float, lifetime: Floats | float, start: Floats, end: Floats) -> Floats:
    """∫ u(a) da over [start, end]."""
    import numpy as np

    lived: Floats = np.minimum(end, lifetime) - np.minimum(start, lifetime)
    return u0 * lived
