"""Whether news of others come so late that robots that each plan for all would take the same room.

What was sent within the latency is known to nobody else. While that is a good part of the window, one robot plans for
all, as where limits are shared: it lends, and nobody sends what was not lent. Only that clocks are trusted there.
Whether it is so who leads says, for all have to do the same. Where limits are shared anyway, who leads plans further
ahead then, and tells everything twice.
"""

import math
from collections.abc import Sequence

from proxy.core.limits import Limit, shortest_window
from proxy.core.shares import Shares
from proxy.core.view import SharedView

LATE = 0.1
"""News are late where they take this part of the shortest window..."""
STAYS = 0.8
"""... and still when they take a little less: so many times that."""
PACE = 0.25
"""It is looked at this often [s]."""


class Lateness:
    """Looks now and then at how long news take; `late` while that is too long for each to decide alone."""

    def __init__(self, view: SharedView, shares: Shares) -> None:
        self._view = view
        self._shares = shares
        self._due = -math.inf
        self.late = False

    def look(self, now: float, limits: Sequence[Limit], waiting: float = 0.0) -> None:
        """See how long news take beside the windows of what robots share, if that falls to us and it is time to.

        They are `waiting` so long on their way besides, where the channel is full [s].
        """
        due = now >= self._due
        if not self._shares.leads:
            leader = self._view.peers.get(self._shares.leader)
            self.late = leader is not None and leader.digest is not None and leader.digest.lends
        self._due = now + PACE if due else self._due
        if not (due and self._shares.leads):
            return
        long = shortest_window(limits) * LATE * (STAYS if self.late else 1.0)
        self.late = max(self._longest_way(), waiting) >= long

    def _longest_way(self) -> float:
        """What messages take from any robot to any other at most, as far as that is known [s]."""
        told = (line.fixed for peer in self._view.peers.values() for line in peer.heard_by.values())
        return max(self._view.longest_way, max(told, default=0.0))
