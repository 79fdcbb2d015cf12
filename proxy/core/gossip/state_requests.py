"""Whom to ask for a state: who is new, and who speaks of a state that we do not have."""

PACE = 0.02
"""Questions follow each other at least this far apart [s]."""
AT_ONCE = 8
"""So many questions do; more may have to wait, as a team of fifty that begins has 2,450 of them."""
FIRST = 0.5
"""An answer is waited for this long, the next ones twice as long each [s]..."""
LONGEST = 30.0
"""... up to this [s]."""


class Asking:
    """The questions that are open, by tag; there are as many as robots at most."""

    def __init__(self, now: float) -> None:
        self._open: dict[str, tuple[float, float]] = {}
        """When to ask next [s], and how long to wait for the answer then [s]."""
        self._next = self._asked_at = now
        self._left = float(AT_ONCE)
        self.asked = 0

    def want(self, now: float, tag: str) -> None:
        """We lack the state of a robot."""
        self._open.setdefault(tag, (now, FIRST))

    def done(self, tag: str) -> None:
        """We have it, or the robot is gone."""
        self._open.pop(tag, None)

    def due(self, now: float, pace: float = PACE) -> str | None:
        """Return whom to ask now, the one that waits longest; None when it is nobody's turn.

        In the long run questions are a `pace` apart [s].
        """
        if not self._open or now < self.next_at():
            return None
        tag = min(self._open, key=lambda t: (self._open[t], t))
        _, patience = self._open[tag]
        self._open[tag] = now + patience, min(2.0 * patience, LONGEST)
        self._left = min(AT_ONCE, self._left + (now - self._asked_at) / pace) - 1.0
        self._asked_at = now
        self._next = now + max(PACE, -self._left * pace)
        self.asked += 1
        return tag

    def next_at(self) -> float:
        """When the next question is due [s]; there may be none."""
        if not self._open:
            return float("inf")
        return max(self._next, min(when for when, _ in self._open.values()))
