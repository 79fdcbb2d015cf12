"""Loss that was not there before: what part of what we send arrives, against what is usual.

Cumulative counts tell the part: what we put on the air, and what the others say they have received of it. Some never
count (plain nodes) and some radios always lose: so only what is lost beyond the usual counts. A decrease is a trial.
When less is sent and as much is lost, load was not the cause; the radio is worse than it was, and that is taken as is.
"""

from collections import deque
from statistics import median

SPAN = 3.0
"""A part is measured over at least this time [s],"""
LEAST = 40
"""and over so many messages."""
REMEMBERED = 30.0
"""The median of so long is the usual [s]."""
LOST = 0.3
"""More than this part beyond the usual is a reason to send less."""
HELPED = 0.8
"""Sending less has helped when less than so much of the loss is left."""
MOST = 64
"""Counts and parts remembered."""


class Arrivals:
    """Our messages of the recent past, sent and arrived."""

    def __init__(self) -> None:
        self._received: dict[str, int] = {}
        self._counts: deque[tuple[float, int, int]] = deque(maxlen=MOST)
        self._parts: deque[tuple[float, float]] = deque(maxlen=MOST)
        self._blamed = (0.0, 0.0)
        """What was usual when load was found to be the cause of loss, and until when that holds [s]."""

    def note(self, now: float, sent: int, peer: str, received: int) -> None:
        """We have sent so many messages so far, copies counted, and a peer says it has received so many of them."""
        if received < self._received.get(peer, received + 1):
            self.forget(peer)
        self._received[peer] = received
        self._counts.append((now, sent, sum(self._received.values())))
        while len(self._counts) > 2 and self._counts[1][0] <= now - SPAN:
            self._counts.popleft()
        (t0, sent0, arrived0), (t1, sent1, arrived1) = self._counts[0], self._counts[-1]
        if t1 - t0 >= SPAN and sent1 - sent0 >= LEAST:
            self._parts.append((now, (arrived1 - arrived0) / (sent1 - sent0)))
        while self._parts and self._parts[0][0] < now - REMEMBERED:
            self._parts.popleft()

    def forget(self, peer: str) -> None:
        """A robot left or started anew: what arrived until now is not comparable."""
        self._received.pop(peer, None)
        self._counts.clear()
        self.accept()

    def accept(self) -> None:
        """What is lost now is how the radio is."""
        self._parts.clear()
        self._blamed = (0.0, 0.0)

    def blame(self, now: float) -> None:
        """What is lost now is lost by load: for a while it does not become usual."""
        self._blamed = (now + REMEMBERED, self._usual(now))

    def lost(self, now: float) -> float:
        """The part that was lost at last beyond the usual; 0 while nothing is known."""
        if not self._parts or self._parts[-1][0] < now - SPAN:
            return 0.0
        usual = self._usual(now)
        return max(0.0, 1.0 - self._parts[-1][1] / usual) if usual > 0.0 else 0.0

    def blamed(self, now: float) -> bool:
        """Whether load was found to be the cause of loss lately."""
        return now < self._blamed[0]

    def _usual(self, now: float) -> float:
        usual = median(part for _, part in self._parts)
        return max(usual, self._blamed[1]) if self.blamed(now) else usual
