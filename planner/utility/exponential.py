"""A value that falls exponentially with age: that of news about what changes at random, at a constant rate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

from planner.utility.base import Floats, Ints, require_above_zero, require_at_least_zero


@dataclass(frozen=True, slots=True)
class Exponential:
    """`u0·exp(−a / tau)`: worth `u0` per second when fresh, and 63 % less with every `tau` [s]."""

    u0: float
    tau: float

    def __post_init__(self) -> None:
        require_at_least_zero("exponential", "u0", self.u0)
        require_above_zero("exponential", "tau", self.tau)

    def value(self, age: Floats) -> Floats:
        """u(a) for every age [1/s]."""
        import numpy as np

        return np.where(age < 0, 0.0, self.u0 * np.exp(-np.maximum(age, 0.0) / self.tau))

    def integral(self, start: Floats, end: Floats) -> Floats:
        """∫ u(a) da over [start, end] for every pair of ages, 0 <= start <= end [1]."""
        return _between(self.u0, self.tau, start, end)

    @classmethod
    def integrals(cls, utilities: Sequence[Self], which: Ints, start: Floats, end: Floats) -> Floats:
        """∫ of `utilities[which[j]]` over `[start[j], end[j]]` for every j [1]."""
        import numpy as np

        u0 = np.array([utility.u0 for utility in utilities])[which]
        tau = np.array([utility.tau for utility in utilities])[which]
        return _between(u0, tau, start, end)


def _between(u0: Floats | float, tau: Floats | float, start: Floats, end: Floats) -> Floats:
    """∫ u(a) da over [start, end]; `expm1` keeps short intervals exact."""
    import numpy as np

    area: Floats = u0 * tau * np.exp(-start / tau) * -np.expm1((start - end) / tau)
    return area
