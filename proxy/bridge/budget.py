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
        came = max(0.0, now - self._updated) * self._rate * part
        self._tokens, self._updated = min(self._burst, self._tokens + came), now
        if self._tokens < cost:
            return False
        self._tokens -= cost
        return True

    def give_back(self, cost: float = 1.0) -> None:
        """What was taken was of no use, as there was no room elsewhere."""
        self._tokens += cost


class Budget:
    """Every sender that is known has a bucket of its own, those that nobody knows share one.

    `each` may cause so much a second, and all together `most`: of many senders each has less. `senders` tells how many
    are known. So one that says too much, or in whose name another one does, takes nothing from the rest.
    """

    def __init__(self, each: float, most: float, senders: Callable[[], int]) -> None:
        self._each = each
        self._most = most
        self._senders = senders
        self._buckets: dict[str, Bucket] = {}

    def admits(self, now: float, sender: str, cost: float = 1.0) -> bool:
        """Whether there is room for more of a sender; an empty name stands for all that are not known."""
        bucket, count = self._buckets.get(sender), self._senders() + 1
        if bucket is None:
            if len(self._buckets) > 2 * count:  # most of them have left
                self._buckets.clear()
            bucket = self._buckets[sender] = Bucket(now, self._each, self._each)
        return bucket.take(now, cost, min(1.0, self._most / (self._each * count)))
