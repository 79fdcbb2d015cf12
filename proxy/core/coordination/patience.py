"""How long one waits for an agreement that does not come."""

import math

from proxy.core.coordination.tuning import TUNING


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
