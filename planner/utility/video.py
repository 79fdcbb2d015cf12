"""A value that falls with the logarithm of age: that of a video image to who watches (`U_vid` of Eq. 9)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

from planner.errors import ProblemError
from planner.finite import finite
from planner.utility.base import Floats, Ints


@dataclass(frozen=True, slots=True)
class Video:
    """The paper's `U_vid`: 1 until the age `a0` [s], then falling with its logarithm, 0 from `a1` [s] on.

    Doubling the frame rate then adds a constant. A reconstruction: the original is Eq. 28 of another paper.
    """

    a0: float = 1 / 30
    a1: float = 10.0

    def __post_init__(self) -> None:
        if not (finite(self.a0) and finite(self.a1) and 0 < self.a0 < self.a1):
            raise ProblemError(f"video utility: needs finite ages 0 < a0 < a1, not a0 = {self.a0}, a1 = {self.a1}")

    def value(self, age: Floats) -> Floats:
        """u(a) for every age [1/s]."""
        import numpy as np

        aged = np.clip(age, self.a0, self.a1)
        return np.where(age < 0, 0.0, 1.0 - np.log(aged / self.a0) / math.log(self.a1 / self.a0))

    def integral(self, start: Floats, end: Floats) -> Floats:
        """∫ u(a) da over [start, end] for every pair of ages, 0 <= start <= end [1]."""
        return _video_area(self.a0, self.a1, end) - _video_area(self.a0, self.a1, start)

    @classmethod
    def integrals(cls, utilities: Sequence[Self], which: Ints, start: Floats, end: Floats) -> Floats:
        """∫ of `utilities[which[j]]` over `[start[j], end[j]]` for every j [1]."""
        import numpy as np

        a0 = np.array([utility.a0 for utility in utilities])[which]
        a1 = np.array([utility.a1 for utility in utilities])[which]
        return _video_area(a0, a1, end) - _video_area(a0, a1, start)


def _video_area(a0: Floats | float, a1: Floats | float, age: Floats) -> Floats:
    """∫ u(a) da over [0, age]; on the middle piece the antiderivative is a(1 + 1/K) − (a/K)·ln(a/a0)."""
    import numpy as np

    fall = np.log(a1 / a0)
    aged = np.clip(age, a0, a1)
    middle: Floats = aged + (aged * (1.0 - np.log(aged / a0)) - a0) / fall
    return np.minimum(age, a0) - a0 + middle
