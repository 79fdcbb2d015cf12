"""How much was told lately."""

from collections import deque


class RecentBytes:
    """Amounts [B] by when they were told [s], and their `total`, which is kept and not summed up at every look."""

    def __init__(self) -> None:
        self.total = 0.0
        self._told: deque[tuple[float, float]] = deque()

    def add(self, now: float, amount: float) -> None:
        """So much is told now."""
        self._told.append((now, amount))
        self.total += amount

    def forget(self, before: float) -> None:
        """Forget what was told before this [s]: windows are closed."""
        told = self._told
        while told and told[0][0] < before:
            self.total -= told.popleft()[1]
        if not told:
            self.total = 0.0

    def fits_at(self, now: float, window: float, room: float) -> float:
        """Return when no more than `room` of it is left in a window: when what must leave it has; now if so already."""
        left, at = self.total, now
        for t, amount in self._told:
            if left <= room and t > now - window:
                break
            left, at = left - amount, max(now, t + window)
        return at
