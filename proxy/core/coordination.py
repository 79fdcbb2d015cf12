"""How robots keep a limit together: who counts what of whom, and which part of every shared limit is ours.

`announce`: each robot plans for all with what it knows and acts on its own samples only; what it sends the others hear
from the air, or from the digest that follows. That holds while news take less than about a tenth of the window, and
while the digests fit into their allowance.

`split`: each robot has a part of every limit (`proxy.core.split`), and needs no news of the others. It is what an
operator configures who needs the limit kept at any latency, and what a team changes over to where news take too long or
announcements cost too much. Each robot says which it finds due, in its digests; the team splits while any of them says
so. Whoever plans for all leaves room for the parts of those who already split.
"""

import math
from collections.abc import Callable, Collection, Sequence

from proxy.core.limits import Limit, shortest_window
from proxy.core.settings import CoreSettings
from proxy.core.view import SharedView
from proxy.core.wire import Digest, tag

LATE = 0.1
"""News are late where they take this part of the shortest window..."""
AFFORDABLE = 0.8
"""... and announcements cost too much where they take this part of the allowance;"""
STILL = 0.8
"""and both still when it is a little less: so many times that."""
PACE = 0.25
"""Both are looked at this often [s]."""


class Coordination:
    """Which coordination is in force here."""

    def __init__(self, now: float, settings: CoreSettings, view: SharedView) -> None:
        self._always = settings.coordination == "split"
        self._own = tag(settings.zid)
        self._view = view
        self._due = now
        self._members: frozenset[str] = frozenset()
        self._splitting: set[str] = set()
        """Tags of the others that say that the team has to split."""
        self.finds_due = False
        """Whether we say so."""

    @property
    def splits(self) -> bool:
        """Whether each robot has a part of every limit."""
        return self._always or self.finds_due or bool(self._splitting)

    def part(self, now: float) -> float:
        """What part of every shared limit we may plan with: ours in `split`, else what is not another's."""
        robots = len(self._view.peers) + 1
        return 1.0 / robots if self.splits else 1.0

    def whole_turn(self, now: float) -> bool:
        """Whether a message may go now that is larger than our part, because nobody else may send."""
        return not self.splits

    def heard(self, digest: Digest) -> None:
        """A digest of another robot came; announcements do not tell."""
        if digest.splits and digest.tag in self._members:
            self._splitting.add(digest.tag)
        elif not digest.brief:
            self._splitting.discard(digest.tag)

    def set_members(self, now: float, members: Collection[str]) -> None:
        """These robots take part, and we."""
        self._members = frozenset(members)
        self._splitting &= self._members

    def look(self, now: float, limits: Sequence[Limit], waiting: float, announcing: Callable[[float], float]) -> bool:
        """Look whether the team has to split; return whether that is news.

        News of others are `waiting` so long on a channel that is full [s]; `announcing` tells what part of the allowance
        announcements take.
        """
        if now < self._due:
            return False
        self._due, before = now + PACE, self.finds_due
        window, still = shortest_window(limits), STILL if before else 1.0
        if not self._view.peers or math.isinf(window):
            self.finds_due = False
        else:
            late = max(self._longest_way(), waiting) >= still * LATE * window
            self.finds_due = late or announcing(now) > still * AFFORDABLE
        return self.finds_due != before

    def due_at(self, now: float) -> float:
        """When this changes by time alone [s]."""
        return self._due if self._view.peers else math.inf

    def _longest_way(self) -> float:
        """What messages take from any robot to any other at most, as far as that is known [s]."""
        told = (line.fixed for peer in self._view.peers.values() for line in peer.heard_by.values())
        return max(self._view.longest_way, max(told, default=0.0))
