"""A value that falls as a power of age and has no time scale of its own."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

from planner.errors import ProblemError
from planner.finite import finite
from planner.utility.base import Floats, Ints

YOUNGEST = sys.float_info.min
"""The value below this age [s] is that at it: large, but finite."""


@dataclass(frozen=True, slots=True)
class Power:
    """`(1 − beta)·a^(−beta)`, 0 < beta < 1: the first `a` seconds are worth `a^(1 − beta)`, without a limit.

    At the age 0 the formula is infinite. The value there is that at the least normal number, and finite; the
    integral is exact, from 0 too.
    """

    beta: float

    def __post_init__(self) -> None:
        if not (finite(self.beta) and 0.0 < self.beta < 1.0):
            raise ProblemError(f"power utility: beta must be between 0 and 1, not {self.beta}")

    def value(self, age: Floats) -> Floats:
        """u(a) for every age [1/s]."""
        import numpy as np

        return np.where(age < 0, 0.0, (1.0 - self.beta) * np.maximum(age, YOUNGEST) ** -self.beta)

    def integral(self, start: Floats, end: Floats) -> Floats:
        """∫ u(a) da over [start, end] for every pair of ages, 0 <= start <= end [1]."""
        return _between(self.beta, start, end)

    @classmethod
    def integrals(cls, utilities: Sequence[Self], which: Ints, start: Floats, end: Floats) -> Floats:
        """∫ of `utilities[which[j]]` over `[start[j], end[j]]` for every j [1]."""
        import numpy as np

        return _between(np.array([utility.beta for utility in utilities])[which], start, end)


def _between(beta: Floats | float, start: Floats, end: Floats) -> Floats:
    """∫ u(a) da over [start, end]; never below 0 by rounding."""
    import numpy as np

    rest = 1.0 - beta
    return np.maximum(end**rest - start**rest, 0.0)
