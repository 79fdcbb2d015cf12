"""How long one waits for an agreement that does not come, and who departed from one."""

import math

from proxy.core.coordination.tuning import TUNING
from proxy.core.protocol.bid import UNIT
from proxy.core.protocol.messages import Digest
from proxy.core.split.agreement import Agreement
from proxy.core.split.table import Table


class Patience:
    """Is over where something has been pending for long; then nobody waits for a while, each time for longer.

    It lasts longer where parts are in force that are worth much more than equal ones: of ten robots with equal messages
    one asked for others, not all had agreed after 6 s, and they gave up for a minute (79 % of a central decider, 98
    now). Where they are worth hardly more, equal parts beat slots whose turns nobody can afford to announce: twelve
    robots reach 74 % so, and 42 where they do not give up.
    """

    def __init__(self) -> None:
        self._pending_since, self._rests_until = math.inf, -math.inf
        self._rest = TUNING.retry_time

    def is_over(self, now: float, news_take: float, *, pending: bool, agreed: bool = False) -> bool:
        """Return whether nobody should wait now; news take so long [s]. `agreed`: such parts are in force."""
        if now < self._rests_until:
            return True
        if not pending:
            if self._pending_since < math.inf:
                self._rest = TUNING.retry_time
            self._pending_since = math.inf
            return False
        self._pending_since = min(self._pending_since, now)
        patience = TUNING.retry_time if agreed else TUNING.agreement_time
        if now < self._pending_since + patience + TUNING.agreement_news * news_take:
            return False
        self.give_up(now)
        return True

    def give_up(self, now: float) -> None:
        """Nobody waits for a while from now on, unless that is so already."""
        if now >= self._rests_until:
            self._rests_until, self._pending_since = now + self._rest, math.inf
            self._rest = min(2.0 * self._rest, TUNING.longest_retry)


class Departed:
    """Robots that say nothing any more of the parts that we agreed on with them: slots that they hold nobody passes on.

    Where they have much of a limit the others give up, too: ten robots with equal messages used 46 % of it (57 now),
    six of which some kept to equal parts had 51 % of the windows over (1 now).
    """

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
