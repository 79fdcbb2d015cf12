"""When there is room: sends leave the windows of the limits one after the other."""

import math
from collections.abc import Iterable, Sequence

from planner import Constraint

Sends = Iterable[tuple[float, tuple[float, ...]]]
"""What was sent, as (time, use)."""
CLOSED = 1e-6
"""Windows are closed: what was sent a whole window ago still counts for this moment [s]."""


def opens(limits: Sequence[Constraint], sends: Sends, needed: tuple[float, ...]) -> float:
    """Return when all limits have room for what is `needed`, if nothing else is sent [s]; never, if it is too much."""
    known = list(sends)
    return max((_opens(c, k, known, needed[k]) for k, c in enumerate(limits)), default=-math.inf)


def _opens(limit: Constraint, k: int, sends: Sequence[tuple[float, tuple[float, ...]]], needed: float) -> float:
    if needed > limit.limit:
        return math.inf
    used = 0.0
    for t, use in sorted(sends, reverse=True):
        used += use[k]
        if used + needed > limit.limit:
            return t + limit.window + CLOSED
    return -math.inf
