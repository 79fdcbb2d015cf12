"""A token bucket: how much may be carried by when."""


class Bucket:
    """Fills at `rate` [B/s] up to `depth` [B]; full at the start. Times are seconds on the caller's clock."""

    def __init__(self, rate: float, depth: float, now: float) -> None:
        self._rate = rate
        self._depth = depth
        self._tokens = depth
        self._filled = now

    def take(self, size: int, now: float) -> bool:
        """Take `size` tokens if there are so many; return whether."""
        self._tokens = min(self._depth, self._tokens + (now - self._filled) * self._rate)
        self._filled = now
        if size > self._tokens:
            return False
        self._tokens -= size
        return True

    def wait(self, size: int, now: float) -> float:
        """Return the time until `size` tokens will be there [s]; 0 when they are."""
        return max(0.0, (size - self._tokens) / self._rate - (now - self._filled))

    def set_rate(self, rate: float, now: float) -> None:
        """Fill at another rate [B/s] from now on."""
        self.take(0, now)
        self._rate = rate
