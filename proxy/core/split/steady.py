"""What has been ours throughout the last window: it falls at once and rises one window later."""

from itertools import pairwise


class Steady:
    """A number, and the least that it was in the last `window` [s].

    What a robot uses in a window is at most what it had when that began: summed over robots that holds as the numbers
    do.
    """

    def __init__(self, now: float, value: int, window: float) -> None:
        self.window = window
        self._values = [(now, value)]

    def set(self, now: float, value: int, unused: float = 0.0) -> None:
        """It is this from now on; what it rises by has been unused for so long [s]."""
        before = self._values[-1][1]
        rise = value - before
        if not rise:
            return
        since = now - unused if rise > 0 else now
        earlier = [entry for entry in self._values if entry[0] <= since]
        later = self._values[len(earlier) :]
        then = (earlier or later[:1])[-1][1]
        least = min(then, *(had for _, had in later), before)
        self._values = [*earlier, (since, least), (since, then + rise), *((at, had + rise) for at, had in later)]
        first = next(i for i, (_, end) in enumerate(self._spans()) if end > since - self.window)
        self._values = self._values[first:]

    def give_up(self, now: float, value: int, room: int, least: int) -> None:
        """It is `value` from now on, and counts as if some room had never been part of it: `least` always was ours."""
        self._values = [(start, min(had, max(had - room, least))) for start, had in self._values]
        self.set(now, value)

    def least(self, now: float) -> int:
        """Return the least that it was in the window until `now`."""
        return min(value for (value, end) in self._spans() if end > now - self.window)

    def rises_at(self, now: float) -> float:
        """Return when the least of a window rises next [s]; infinite if it does not by itself."""
        least = self.least(now)
        ends = [end for value, end in self._spans() if value == least and end > now - self.window]
        return max(ends) + self.window

    def _spans(self) -> list[tuple[int, float]]:
        """Each value and when it ended."""
        spans = [(value, end) for (_, value), (end, _) in pairwise(self._values)]
        return [*spans, (self._values[-1][1], float("inf"))]
