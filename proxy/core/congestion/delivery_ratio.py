"""Loss that was not there before: what part of our messages arrives, against the usual part.

A decrease for loss is a trial: where as much is lost when less is sent, the radio is taken to be worse than it was.
"""

from collections import deque
from statistics import median

from proxy.core.congestion.tuning import TUNING


class DeliveryRatio:
    """Our messages of the recent past, sent and arrived."""

    def __init__(self) -> None:
        self._received: dict[str, int] = {}
        self._counts: deque[tuple[float, int, int]] = deque(maxlen=TUNING.remembered)
        """When they were noted [s], messages sent, and messages that arrived at all robots together."""
        self._ratios: deque[tuple[float, float]] = deque(maxlen=TUNING.remembered)
        self._congested_until = 0.0
        self._usual_before = 0.0
        """What was usual when load was last found to be the cause of loss."""

    def note(self, now: float, sent: int, peer: str, received: int) -> None:
        """We have sent so many messages so far, copies counted, and a peer reports how many of them it received."""
        if received < self._received.get(peer, received + 1):
            self.forget(peer)
        self._received[peer] = received
        self._counts.append((now, sent, sum(self._received.values())))
        while len(self._counts) > 2 and self._counts[1][0] <= now - TUNING.ratio_span:
            self._counts.popleft()
        (t0, sent0, arrived0), (t1, sent1, arrived1) = self._counts[0], self._counts[-1]
        if t1 - t0 >= TUNING.ratio_span and sent1 - sent0 >= TUNING.ratio_messages:
            self._ratios.append((now, (arrived1 - arrived0) / (sent1 - sent0)))
        while self._ratios and self._ratios[0][0] < now - TUNING.usual_span:
            self._ratios.popleft()

    def forget(self, peer: str) -> None:
        """A robot left or started anew: what arrived until now is not comparable."""
        self._received.pop(peer, None)
        self._counts.clear()
        self.accept()

    def accept(self) -> None:
        """What is lost now is how the radio is."""
        self._ratios.clear()
        self._congested_until = self._usual_before = 0.0

    def attribute_to_load(self, now: float) -> None:
        """What is lost now is lost by load: for a while it does not become usual."""
        self._congested_until, self._usual_before = now + TUNING.usual_span, self._usual(now)

    def excess_loss(self, now: float) -> float:
        """The part that was lost at last beyond the usual; 0 while nothing is known."""
        if not self._ratios or self._ratios[-1][0] < now - TUNING.ratio_span:
            return 0.0
        usual = self._usual(now)
        return max(0.0, 1.0 - self._ratios[-1][1] / usual) if usual > 0.0 else 0.0

    def congested(self, now: float) -> bool:
        """Whether load was found to be the cause of loss lately."""
        return now < self._congested_until

    def _usual(self, now: float) -> float:
        usual = median(ratio for _, ratio in self._ratios)
        return max(usual, self._usual_before) if self.congested(now) else usual
