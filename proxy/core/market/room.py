"""When there is room: sends leave the windows of the limits one after the other.

Room that our own send leaves is ours to wait for. Room that another robot's send leaves is not: several would wait for
it, and send at once when it opens (in a team of ten 13 % of the windows were exceeded). Small samples that are not
contested wait for that, too: there is room for all of them.
"""

import math
from collections.abc import Iterable, Sequence

from planner import Constraint
from proxy.core.market.tuning import TUNING
from proxy.core.model.limits import Send


def opens(
    limits: Sequence[Constraint],
    own: Iterable[Send],
    others: Iterable[Send],
    needed: tuple[float, ...],
    *,
    anybodys: bool = False,
) -> float:
    """Return when all limits have room for what is `needed`, if nothing else is sent [s]; −∞ where there is room now.

    Never (∞) where it is more than a limit, or where the room opens that another robot's send leaves, unless `anybodys`
    room will do.
    """
    sends = sorted([*((t, True, use) for t, use in own), *((t, anybodys, use) for t, use in others)], reverse=True)
    return max((_opens(c, k, sends, needed[k]) for k, c in enumerate(limits)), default=-math.inf)


def _opens(limit: Constraint, k: int, sends: Sequence[tuple[float, bool, tuple[float, ...]]], needed: float) -> float:
    if needed > limit.limit:
        return math.inf
    used = 0.0
    for t, ours, use in sends:
        used += use[k]
        if used + needed > limit.limit:
            return t + limit.window + TUNING.closed if ours else math.inf
    return -math.inf
