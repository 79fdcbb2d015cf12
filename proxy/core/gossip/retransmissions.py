"""An announcement is told again where many robots miss it: what nobody hears of again for long is planned without.

Robots that missed a sample and its announcement took the room for free: where 30 % of all that is broadcast was lost,
5 to 8 % of the windows of four robots with cameras were over the limit.
"""

import math
from dataclasses import replace

from proxy.core.protocol.messages import Digest

AFTER = 0.03
"""It is told again after so long, then after twice as long, and so on [s]..."""
MISSED = 0.003
"""... until no more than this part of the robots have missed it, by what is lost in the mean..."""
SO_FAR, MOST = 2, 3
"""Who missed it missed the sample and its announcement, two times; it is told again so often at most."""


class Repeats:
    """The newest announcement of ours, and when it is told again."""

    def __init__(self) -> None:
        self.due_at = math.inf
        """When to tell it again [s]."""
        self._left, self._after = 0, AFTER
        self._digest: Digest | None = None

    def announced(self, digest: Digest, lost: float) -> None:
        """This tells of a sample that went before it; such a part of each is lost."""
        times = math.ceil(math.log(MISSED) / math.log(lost) - 1e-9) if lost > MISSED else 1
        self._digest, self._left, self._after = digest, min(MOST, max(0, times - SO_FAR)), AFTER
        self.due_at = digest.sent + AFTER if self._left else math.inf

    def again(self, now: float) -> Digest | None:
        """Return what is to be told again now, if that is due."""
        if now < self.due_at or self._digest is None:
            return None
        self._left, self._after = self._left - 1, 2.0 * self._after
        self.due_at = now + self._after if self._left else math.inf
        return replace(self._digest, sent=now)
