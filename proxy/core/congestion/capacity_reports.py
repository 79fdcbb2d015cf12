"""What the others tell of what the channel bears, and whose word counts.

Where one robot leads its word counts: what it has in force, how much of that all use together, and for how little a
queue that drains leaves room. The others tell it what they have against that, if anything. Where nobody leads, or we
do, the least counts that any of them tells; but of those whom our samples go to, and of the rest, the word of a single
one does not where there are several: it may be far away.
"""

import math
from collections.abc import Collection, Sequence

from proxy.core.model.limits import Limit
from proxy.core.protocol.messages import Digest

FRESH = 5.0
"""What a robot tells counts for so long [s]."""
BRIEFLY = 0.5
"""What the leader tells of a queue that drains counts for so long [s]."""


class Words:
    """Of every adaptive limit the last words of each robot, by tag, as parts of its ceiling."""

    def __init__(self, own: str) -> None:
        self._own = own
        self._told: dict[str, tuple[float, tuple[float, ...]]] = {}
        self.leader = ""
        self.follows = False
        """Whether another robot leads whose word we have."""

    @property
    def leads(self) -> bool:
        """Whether it is we who lead."""
        return self.leader == self._own

    def note(self, now: float, digest: Digest) -> None:
        """A robot tells something."""
        self._told[digest.tag] = now, digest.capacity

    def forget(self, peer: str) -> None:
        """A robot left."""
        self._told.pop(peer, None)

    def follow(self, now: float, leader: str) -> None:
        """The leader is this one now, if anybody."""
        self.leader = leader
        self.follows = not self.leads and self._told.get(leader, (-math.inf, ()))[0] > now - FRESH

    def bound(self, now: float, k: int, limit: Limit, receivers: Collection[str]) -> float:
        """What the others leave of a limit: what those tell who receive what we send, and what the rest does."""
        return min(self._bound(now, k, limit, receivers, inside=inside) for inside in (True, False))

    def least(self, now: float, k: int) -> float:
        """The least that any other robot tells of a limit; nothing when none does."""
        return min((told[k] for _, told in self._words(now, k)), default=0.0)

    def used(self, limits: Sequence[Limit]) -> tuple[float, ...] | None:
        """What part of every limit is used by all, if a leader tells."""
        count = len(limits)
        told = self._told[self.leader][1] if self.follows else ()
        return told[count : 2 * count] if len(told) >= 2 * count else None

    def draining(self, now: float, k: int, count: int) -> float:
        """For how much of the `k`-th of so many limits a queue leaves room, as the leader has just told."""
        t, told = self._told[self.leader] if self.follows else (-math.inf, ())
        return told[2 * count + k] if t >= now - BRIEFLY and len(told) == 3 * count else 1.0

    def _bound(self, now: float, k: int, limit: Limit, receivers: Collection[str], *, inside: bool) -> float:
        """What those tell who receive what we send, or the others: the least but one, where there are several."""
        words = sorted(
            min(max(told[k], limit.least), 1.0) for peer, told in self._words(now, k) if (peer in receivers) is inside
        )
        return words[min(1, len(words) - 1)] if words else 1.0

    def _words(self, now: float, k: int) -> list[tuple[str, tuple[float, ...]]]:
        """Who tells of a limit, and what: who leads, where we follow."""
        heard = {self.leader: (now, self._told[self.leader][1])} if self.follows else self._told
        return [(peer, told) for peer, (t, told) in heard.items() if t >= now - FRESH and len(told) > k]
