"""How much of what others say is taken in, of each and of all: what is more is left out before anybody looks at it."""

from collections.abc import Callable


class Bucket:
    """Tokens that come at `rate` a second; `burst` of them at most are kept."""

    def __init__(self, now: float, rate: float, burst: float) -> None:
        self._rate = rate
        self._burst = burst
        self._tokens = burst
        self._updated = now

    def take(self, now: float, cost: float = 1.0, part: float = 1.0) -> bool:
        """Take `cost` tokens if there are as many; they come at a `part` of the rate only."""
        self._refill(now, part)
        if self._tokens < cost:
            return False
        self._tokens -= cost
        return True

    def owe(self, now: float, cost: float) -> None:
        """Take `cost` tokens that there may not be yet; no more than a burst is owed."""
        self._refill(now, 1.0)
        self._tokens = max(-self._burst, self._tokens - cost)

    def give_back(self, cost: float = 1.0) -> None:
        """What was taken was of no use, as there was no room elsewhere."""
        self._tokens += cost

    def _refill(self, now: float, part: float) -> None:
        came = max(0.0, now - self._updated) * self._rate * part
        self._tokens, self._updated = min(self._burst, self._tokens + came), now


class Budget:
    """Every sender that is known has buckets of its own, those that nobody knows share one pair.

    `each` may cause so much a second, and all together `most`. `senders` tells how many are known: an equal part of
    `most` each has for certain, and more as long as all together leave room. So one that says too much, or in whose
    name another one does, takes nothing from the rest, and neither do those that say nothing, however many.
    """

    def __init__(self, each: float, most: float, senders: Callable[[], int]) -> None:
        self._each = each
        self._most = most
        self._senders = senders
        self._all = Bucket(0.0, most, most)
        self._buckets: dict[str, tuple[Bucket, Bucket]] = {}
        """What each sender may cause, and what of that it may cause for certain."""

    def admits(self, now: float, sender: str, cost: float = 1.0) -> bool:
        """Whether there is room for more of a sender; an empty name stands for all that are not known."""
        buckets, count = self._buckets.get(sender), self._senders() + 1
        if buckets is None:
            if len(self._buckets) > 2 * count:  # most of them have left
                self._buckets.clear()
            buckets = Bucket(now, self._each, self._each), Bucket(now, self._each, self._each)
            self._buckets[sender] = buckets
        own, certain = buckets
        if not own.take(now, cost):
            return False
        if certain.take(now, cost, min(1.0, self._most / (self._each * count))):
            self._all.owe(now, cost)
            return True
        if self._all.take(now, cost):
            return True
        own.give_back(cost)
        return False
