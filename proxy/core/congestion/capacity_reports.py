"""What the others report that the channel bears, and whose report counts.

That of a leader; where nobody else leads the least one, but no single one of several: it may be far away.
"""

import math
from collections.abc import Collection

from proxy.core.congestion.tuning import TUNING
from proxy.core.model.limits import Limit
from proxy.core.protocol.messages import Digest


class CapacityReports:
    """The last report of each robot, by tag: parts of the ceilings of all adaptive limits."""

    def __init__(self, own: str) -> None:
        self._own = own
        self._reports: dict[str, tuple[float, tuple[float, ...]]] = {}
        self.leader = ""
        self.follows = False
        """Whether another robot leads whose report we have."""

    @property
    def leads(self) -> bool:
        """Whether it is we who lead."""
        return self.leader == self._own

    def note(self, now: float, digest: Digest) -> None:
        """A robot reports something."""
        self._reports[digest.tag] = now, digest.capacity

    def forget(self, peer: str) -> None:
        """A robot left."""
        self._reports.pop(peer, None)

    def set_leader(self, now: float, leader: str) -> None:
        """This robot leads now, if anybody."""
        self.leader = leader
        self.follows = not self.leads and self._reports.get(leader, (-math.inf, ()))[0] > now - TUNING.lifetime

    def bound(self, now: float, k: int, limit: Limit, receivers: Collection[str]) -> float:
        """What the others leave of a limit: what our receivers report, and what the rest does."""
        return min(self._bound(now, k, limit, receivers, inside=inside) for inside in (True, False))

    def least(self, now: float, k: int) -> float:
        """The least that any other robot reports of a limit; nothing when none does."""
        return min((report[k] for _, report in self._fresh(now, k)), default=0.0)

    def used(self, count: int) -> tuple[float, ...] | None:
        """What part of each of so many limits all use, if a leader reports it."""
        report = self._reports[self.leader][1] if self.follows else ()
        return report[count : 2 * count] if len(report) >= 2 * count else None

    def _bound(self, now: float, k: int, limit: Limit, receivers: Collection[str], *, inside: bool) -> float:
        """What our receivers report, or the others: the least but one, where there are several."""
        reports = sorted(
            min(max(report[k], limit.least), 1.0)
            for peer, report in self._fresh(now, k)
            if (peer in receivers) is inside
        )
        return reports[min(1, len(reports) - 1)] if reports else 1.0

    def _fresh(self, now: float, k: int) -> list[tuple[str, tuple[float, ...]]]:
        """The reports on a limit that count: that of the leader alone, where we follow."""
        counting = {self.leader: (now, self._reports[self.leader][1])} if self.follows else self._reports
        return [(p, report) for p, (t, report) in counting.items() if t >= now - TUNING.lifetime and len(report) > k]
