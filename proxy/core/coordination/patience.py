"""How long one waits for an agreement that does not come."""

import math

from proxy.core.coordination.tuning import TUNING


class Patience:
    """Is over where something has been pending for long; then nobody waits for a while, each time for longer."""

    def __init__(self) -> None:
        self._pending_since, self._rests_until = math.inf, -math.inf
        self._rest = TUNING.retry_time

    def is_over(self, now: float, news_take: float, *, pending: bool) -> bool:
        """Return whether nobody should wait now; news take so long [s]."""
        if now < self._rests_until:
            return True
        if not pending:
            if self._pending_since < math.inf:
                self._rest = TUNING.retry_time
            self._pending_since = math.inf
            return False
        self._pending_since = min(self._pending_since, now)
        if now < self._pending_since + TUNING.agreement_time + TUNING.agreement_news * news_take:
            return False
        self.give_up(now)
        return True

    def give_up(self, now: float) -> None:
        """Nobody waits for a while from now on, unless that is so already."""
        if now >= self._rests_until:
            self._rests_until, self._pending_since = now + self._rest, math.inf
            self._rest = min(2.0 * self._rest, TUNING.longest_retry)
