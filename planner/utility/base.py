"""What a message utility function is, and what its parameters may be.

A daemon that has nothing to decide needs no NumPy, which takes 12 MB and 0.1 s: so whoever computes with it imports it
there, and a utility without it can be made, compared and sent.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol, Self, TypeAlias, TypeVar, runtime_checkable

from planner.errors import ProblemError
from planner.finite import finite

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

Floats: TypeAlias = "npt.NDArray[np.float64]"
Ints: TypeAlias = "npt.NDArray[np.int64]"
Flags: TypeAlias = "npt.NDArray[np.bool_]"
Shared = TypeVar("Shared")


class MessageUtility(Protocol):
    """Value per second of a message as a function of its age a = t − t_gen [s]; 0 before it exists."""

    def value(self, age: Floats) -> Floats:
        """u(a) for every age [1/s]."""

    def integral(self, start: Floats, end: Floats) -> Floats:
        """∫ u(a) da over [start, end] for every pair of ages, 0 <= start <= end [1]."""


@runtime_checkable
class Batched(Protocol):
    """A kind of utility that integrates many messages in one call: a decision has no time for a loop."""

    @classmethod
    def integrals(cls, utilities: Sequence[Self], which: Ints, start: Floats, end: Floats) -> Floats:
        """∫ of `utilities[which[j]]` over `[start[j], end[j]]` for every j [1]."""


def told_apart(objects: Sequence[Shared]) -> tuple[list[Shared], Ints]:
    """Return each object once, and for every one of them all which of these it is: most messages share theirs."""
    import numpy as np

    keys = list(map(id, objects))
    distinct = dict(zip(keys, objects, strict=True))
    place = {key: number for number, key in enumerate(distinct)}
    return list(distinct.values()), np.array([place[key] for key in keys], dtype=np.int64)


def require_at_least_zero(kind: str, parameter: str, value: float) -> None:
    """Raise ProblemError unless the value is finite and >= 0."""
    if not (finite(value) and value >= 0):
        raise ProblemError(f"{kind} utility: {parameter} must be a finite number >= 0, not {value!r}")


def require_above_zero(kind: str, parameter: str, value: float) -> None:
    """Raise ProblemError unless the value is finite and > 0."""
    if not (finite(value) and value > 0):
        raise ProblemError(f"{kind} utility: {parameter} must be a finite number > 0, not {value!r}")
