"""Rooms: what each robot keeps to where news of others take a good part of the window.

Where all plan for all, what was sent within the latency is known to nobody else, so two robots may take the same room.
The later news come, the more often: so there each robot keeps to *rooms*, each for one message of a stream in every
window. All work out alike whose they are, from what changes slowly and is told to all: what streams are worth, how
often and how large their messages are. So the union holds at any latency, as far as views agree. Streams that gain
alike are told apart by their names, not by what each robot measures a little differently. Who gets a room waits with
it until the others can have heard why.
"""

import math
from collections import deque
from collections.abc import Sequence
from zlib import crc32

from proxy.core.limits import Limit
from proxy.core.slots import MARGIN, Demand, allot, demands
from proxy.core.view import SharedView

LATE = 0.1
"""There are rooms where news take this part of the shortest window..."""
STAYS = 0.8
"""... and still when they take a little less: so many times that."""
PACE = 0.25
"""Whose rooms are is worked out this often [s]..."""
EACH = 1e-3
"""... where many streams compete only after so long for each of them [s]."""
APART = 0.1
"""What streams gain is told apart by their names by up to so much."""
WAIT = 1.0
"""Who gets a room waits so long with it, besides the way there and back [s]."""
STEP = 0.05
"""Ways are told apart by this part of the window."""
EXACT = 1e-6
"""What rounding may take of a limit."""


class Rooms:
    """What this robot holds of each limit; everything while news are quick."""

    def __init__(self, view: SharedView) -> None:
        self._view = view
        self._latency = 0.0
        self._due = -math.inf
        self._late = False
        self._held: deque[tuple[float, tuple[float, ...]]] = deque()
        """What rooms of ours were since then, of each limit, as far as it matters."""

    @property
    def late(self) -> bool:
        """Whether there are rooms: news take long."""
        return self._late

    def look(self, now: float, limits: Sequence[Limit], waiting: float = 0.0) -> None:
        """Work out whose the rooms are, if it is time to; news are `waiting` so long on their way besides [s]."""
        if now < self._due:
            return
        self._due = now + max(PACE, EACH * sum(1 for _ in self._view.streams()))
        shared = [limit for limit in limits if limit.shared]
        window = min((limit.window for limit in shared), default=math.inf)
        self._latency = self._longest_way()
        self._late = max(self._latency, waiting) >= window * LATE * (STAYS if self._late else 1.0)
        if not self._late:
            self._held.clear()
            return
        self._held.append((now, self._ours(now, shared)))
        since = now - WAIT - 2.0 * self._latency
        while len(self._held) > 1 and self._held[1][0] <= since:
            self._held.popleft()

    def held(self, k: int, limit: Limit) -> float:
        """What is ours of the `k`-th limit: the least it was since the others can have heard of it."""
        if not limit.shared or not self._late:
            return limit.limit
        return min((held[k] for _, held in self._held if k < len(held)), default=0.0)

    def _longest_way(self) -> float:
        """What messages take from any robot to any other at most, as far as that is known [s]."""
        peers = self._view.peers.values()
        told = (line.fixed for peer in peers for line in peer.heard_by.values())
        return max([*(peer.offset.latency for peer in peers), *told], default=0.0)

    def _ours(self, now: float, limits: Sequence[Limit]) -> tuple[float, ...]:
        step = STEP * min((limit.window for limit in limits), default=1.0)
        latency = step * round(self._latency / step)
        found = demands(now, self._view, limits, lambda stream: (latency, float(len(self._view.gaining(stream)))))
        wanted = [_common(demand, limits) for demand in found]
        counts = allot(wanted, [(1.0 + EXACT) * limit.limit for limit in limits], {})
        ours = [demand for demand in wanted if demand.place[0] == self._view.settings.robot]
        return tuple(
            min(limit.limit, (1.0 + EXACT) * sum(counts[demand.place] * demand.use[k] for demand in ours))
            for k, limit in enumerate(limits)
        )


def _common(demand: Demand, limits: Sequence[Limit]) -> Demand:
    """Return a demand that is told apart from others by its name, and for no more than the whole."""
    factor = 1.0 + APART * crc32("/".join(demand.place).encode()) / 2**32
    use = tuple(min(use / MARGIN, limit.limit) for use, limit in zip(demand.use, limits, strict=True))
    return Demand(demand.place, use, tuple(gain * factor for gain in demand.gains))
