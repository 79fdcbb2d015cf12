"""What robots tell each other beyond what the limits leave to it, so that it counts like samples.

The allowance may be spent ahead of time: then a window holds more digests than the limits leave out. Ten robots with
five messages to a window exceeded the limit in 9 to 20 % of their windows where that did not count, in unicast at 20
and 100 ms, and in 0 to 13 % where it does (one seed).
"""

from proxy.core.gossip.recent_bytes import RecentBytes


class Excess:
    """What was told within a window, and which part of it was more than may be; each part counts for a whole window."""

    def __init__(self) -> None:
        self._said, self._over = RecentBytes(), RecentBytes()

    def note(self, now: float, size: float, window: float, allowed: float) -> float:
        """Return how much of these bytes is more than is allowed in the window that ends now [B]."""
        self._said.forget(now - window)
        self._over.forget(now - window)
        self._said.add(now, size)
        over = max(0.0, min(size, self._said.total - allowed - self._over.total))
        if over > 0.0:
            self._over.add(now, over)
        return over
