"""Samples that were dropped although nobody decided so: said in the log, one line a minute and reason."""

import math

from proxy.core.interface.commands import Notice
from proxy.core.samples.counts import Counts
from proxy.core.samples.tuning import TUNING

REASONS = {
    "dropped:overflow": "too many waited to be decided",
    "dropped:full": "too many waited for the mesh",
    "dropped:egress": "the mesh session did not take them",
}


class Unplanned:
    """Looks at what was counted."""

    def __init__(self, counts: Counts) -> None:
        self._counts = counts
        self._said = dict.fromkeys(REASONS, 0)
        self._next = dict.fromkeys(REASONS, -math.inf)

    def look(self, now: float) -> list[Notice]:
        """Return what is to be said."""
        dropped = self._counts.by_reason
        return [
            self._notice(now, reason)
            for reason, said in self._said.items()
            if dropped[reason] > said and now >= self._next[reason]
        ]

    def _notice(self, now: float, reason: str) -> Notice:
        total = self._counts.by_reason[reason]
        new, self._said[reason], self._next[reason] = total - self._said[reason], total, now + TUNING.warnings_apart
        text = f"samples dropped, {REASONS[reason]}: {new}, {total} in all ({reason})"
        return Notice("warning", text, {"reason": reason, "new": new, "total": total})
