"""When there is room: sends leave the windows of the limits one after the other.

Room that another robot's send leaves is not ours: several would wait for it and send at once (in a team of ten 13 % of
the windows were over). Who leads waits for that, too, and what is not contested does in turn.
"""

import math
from bisect import bisect_right
from collections.abc import Iterable, Sequence
from enum import Enum
from itertools import accumulate
from typing import Protocol

from planner import Constraint
from proxy.core.market.tuning import TUNING
from proxy.core.model.limits import Send


class Room(Enum):
    """Which room a sample waits for."""

    OWN = "own"
    """What our own sends leave."""
    IN_TURN = "in turn"
    """What any robot's sends leave, when its turn comes to us."""
    ANYBODYS = "anybodys"
    """What any robot's sends leave."""


class Departures:
    """What was sent, newest first, and what leaves the windows with each send: summed up once for all who ask."""

    def __init__(self, own: Iterable[Send], others: Iterable[Send], *, anybodys: bool = False) -> None:
        sends = sorted([*((t, True, use) for t, use in own), *((t, anybodys, use) for t, use in others)], reverse=True)
        self._sends = [(t, ours) for t, ours, _ in sends]
        self._used = [list(accumulate(each)) for each in zip(*(use for *_, use in sends), strict=True)]
        """By constraint, what each send and all after it use."""

    def opens(self, limits: Sequence[Constraint], needed: tuple[float, ...]) -> float:
        """Return when all limits have room for what is `needed`, if nothing else is sent [s]; −∞ where there is now.

        Never (∞) where it is more than a limit, or in room that another robot leaves, unless `anybodys` will do.
        """
        return max((self._opens(c, k, needed[k]) for k, c in enumerate(limits)), default=-math.inf)

    def _opens(self, limit: Constraint, k: int, needed: float) -> float:
        if needed > limit.limit:
            return math.inf
        used = self._used[k] if self._used else []
        place = bisect_right(used, limit.limit, key=lambda amount: amount + needed)
        if place == len(used):
            return -math.inf
        t, ours = self._sends[place]
        return t + limit.window + TUNING.closed if ours else math.inf


class OwnDepartures:
    """The same where nobody else sent anything since then [s]: two look-ups in our own sends, and no sum."""

    def __init__(self, own: "Sends", since: float) -> None:
        self._own = own
        self._since = since

    def opens(self, limits: Sequence[Constraint], needed: tuple[float, ...]) -> float:
        """Return when all limits have room for what is `needed`, if nothing else is sent [s]."""
        return max((self._opens(c, k, needed[k]) for k, c in enumerate(limits)), default=-math.inf)

    def _opens(self, limit: Constraint, k: int, needed: float) -> float:
        if needed > limit.limit:
            return math.inf
        t = self._own.exceeded_since(k, limit.limit - needed)
        return t + limit.window + TUNING.closed if t >= self._since else -math.inf


class Sends(Protocol):
    """Our own sends."""

    def exceeded_since(self, k: int, amount: float) -> float:
        """Return when that was sent with which all later sends use more than an amount of limit `k` [s]; else −∞."""

    @property
    def changes(self) -> int:
        """How often they changed."""

    def since(self, t: float) -> list[Send]:
        """Return what was sent since then, oldest first."""


class Openings:
    """The departures of one kind of room that were asked for last: they stay the same until somebody sends."""

    def __init__(self) -> None:
        self._of: tuple[int, tuple[Send, ...]] = -1, ()
        self._known: tuple[float, Departures | None] = math.inf, None
        """Since when they hold what was sent [s], and they."""

    def after(
        self, since: float, own: Sends, others: tuple[Send, ...], *, anybodys: bool
    ) -> Departures | OwnDepartures:
        """Return the departures of what was sent since then, or since earlier [s]."""
        if not others:
            return OwnDepartures(own, since)
        if self._of[0] != own.changes or self._of[1] is not others:
            self._of, self._known = (own.changes, others), (math.inf, None)
        known_since, known = self._known
        if known is None or since < known_since:
            counting = [send for send in others if send[0] >= since]
            known = Departures(own.since(since), counting, anybodys=anybodys)
            self._known = since, known
        return known
