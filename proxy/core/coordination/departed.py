"""Robots that say nothing any more of the parts that we agreed on with them: slots that they hold nobody passes on.

Where they have much of a limit the others give up, too: ten robots with equal messages used 46 % of it (57 now), six of
which some kept to equal parts had 51 % of the windows over (1 now).
"""

from proxy.core.protocol.bid import UNIT
from proxy.core.protocol.messages import Digest
from proxy.core.split.agreement import Agreement
from proxy.core.split.table import Table


class Departed:
    """Takes note of them by what digests say."""

    def __init__(self) -> None:
        self._table: Table | None = None
        self._tags: set[str] = set()
        """Who departed since that table was agreed on."""

    def share(self, digest: Digest, agreement: Agreement) -> float:
        """Return what part of a limit those have that departed, by table and slots, now that this digest came."""
        if agreement.newcomer:
            return 0.0
        if (table := agreement.log.agreed) is not self._table:
            self._table, self._tags = table, set()
        if not digest.brief and digest.tag in table.bidders:
            (self._tags.add if digest.split is None else self._tags.discard)(digest.tag)
        held = sum(turn.slot.size for turn in table.turns if turn.holder in self._tags)
        return (held + sum(table.allocation.parts.get(tag, 0) for tag in self._tags)) / UNIT
