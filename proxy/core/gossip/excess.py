"""What robots tell each other beyond what the limits leave to it, so that it counts like samples.

The allowance may be spent ahead of time: then a window holds more digests than the limits leave out. Ten robots with
five messages to a window exceeded the limit in 9 to 20 % of their windows where that did not count, in unicast at 20
and 100 ms, and in 0 to 13 % where it does (one seed).
"""

from collections import deque


class Excess:
    """What was told within a window, and which part of it was more than may be; each part counts for a whole window."""

    def __init__(self) -> None:
        self._said: deque[tuple[float, float]] = deque()
        self._over: deque[tuple[float, float]] = deque()

    def note(self, now: float, size: float, window: float, allowed: float) -> float:
        """Return how much of these bytes is more than is allowed in the window that ends now [B]."""
        for past in (self._said, self._over):
            while past and past[0][0] < now - window:
                past.popleft()
        self._said.append((now, size))
        known = sum(amount for _, amount in self._over)
        over = max(0.0, min(size, sum(amount for _, amount in self._said) - allowed - known))
        if over > 0.0:
            self._over.append((now, over))
        return over
