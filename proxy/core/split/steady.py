"""What has been ours throughout the last window: it falls at once and rises one window later."""

from itertools import pairwise


class Steady:
    """A number, and the least that it was in the last `window` [s].

    Why one window suffices: what a robot uses in a window is at most what it had at each moment of the window before,
    so at most what it had when the window began. Summed over robots this holds when the numbers do at every moment.
    """

    def __init__(self, now: float, value: int, window: float) -> None:
        self.window = window
        self._values = [(now, value)]

    @property
    def value(self) -> int:
        """What it is."""
        return self._values[-1][1]

    @property
    def changed(self) -> float:
        """When it changed last [s]."""
        return self._values[-1][0]

    def set(self, now: float, value: int) -> None:
        """It is this from now on."""
        if value != self.value:
            self._values.append((now, value))
            later = [i for i, (_, end) in enumerate(self._spans()) if end > now - self.window]
            self._values = self._values[later[0] :] if later else self._values[-1:]

    def lift(self, now: float, value: int, unused: float) -> None:
        """It rises to `value`, and what it rises by has been unused for so long [s]."""
        since = max(self.changed, now - unused) if value > self.value else now
        self.set(min(now, since), value)

    def give_up(self, now: float, value: int, room: int, least: int) -> None:
        """It is `value` from now on, and counts as if some room had never been part of it: `least` always was ours.

        Other room that came meanwhile may not be ours throughout the window, and does not stand in for this one.
        """
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
        return [*spans, (self.value, float("inf"))]
