"""What specs say besides worth and limits: what is left to the planner, and what happens without it."""

from dataclasses import dataclass
from typing import Literal

TypeMode = Literal["pass", "shadow", "enforce"]
"""What is done with decisions on a type: as the modes of the daemon."""
Deletes = Literal["bypass", "decide"]
Queries = Literal["pass", "drop"]

FLOOR = 0.1
"""Part of every limit that traffic without a spec leaves to covered streams, unless specs say otherwise."""


@dataclass(frozen=True, slots=True)
class Fallback:
    """The static rule for when the planner fails.

    Samples of Zenoh priorities up to `urgent` may take all that the limits leave. Of the others each may take `part` of
    it, and all pass token buckets, which that part of what is ours fills.
    """

    urgent: int = 4
    part: float = 0.5


FALLBACK = Fallback()


@dataclass(frozen=True, slots=True)
class Guarantee:
    """What each stream of a type shall have whatever it is worth, where the limits allow it; None: nothing."""

    min_rate: float | None = None
    """Samples sent [1/s]."""
    max_age: float | None = None
    """Age of the newest sample that a receiver has [s]."""

    @property
    def rate(self) -> float:
        """Samples [1/s] that it takes at least."""
        return max(self.min_rate or 0.0, 1.0 / self.max_age if self.max_age else 0.0)


NO_GUARANTEE = Guarantee()
