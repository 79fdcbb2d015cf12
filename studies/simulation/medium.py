"""A shared medium: one queue of a rate that may change, and a way through the air that differs by pair of robots."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from random import Random

RELIABLE = 0.018
"""What is sent reliably takes so much longer than a digest [s]."""
RETRY = 0.2
"""What is sent reliably is sent again after this time [s]."""
MOST_TRIES = 50
"""So often at most."""
REORDERED = 0.05
"""A reordered message is this much later [s]."""


@dataclass(frozen=True, slots=True)
class Way:
    """From one robot to another: `delay` [s], plus exponentially distributed `jitter` (mean, [s]).

    `loss`, `duplication` and `reordering` are probabilities; what is not reordered arrives in the order sent.
    """

    delay: float = 0.002
    jitter: float = 0.0
    loss: float = 0.0
    duplication: float = 0.0
    reordering: float = 0.0


@dataclass(slots=True)
class Medium:
    """Serves what is offered in order of arrival.

    `rate` is in B/s; with `rates`, pairs of time [s] and rate, it changes. `delay` to `reordering` are those of every
    `Way` that `ways` does not hold by (sender, receiver). Each pair has random numbers of its own, so that what one
    robot sends changes the fate of nobody else's messages.
    """

    rate: float
    delay: float = 0.002
    loss: float = 0.0
    jitter: float = 0.0
    duplication: float = 0.0
    reordering: float = 0.0
    ways: dict[tuple[str, str], Way] = field(default_factory=dict)
    rates: tuple[tuple[float, float], ...] = ()
    seed: int = 0
    busy_until: float = -math.inf
    carried: int = 0
    _random: dict[tuple[str, str, str], Random] = field(default_factory=dict)
    _last: dict[tuple[str, str], float] = field(default_factory=dict)

    def way(self, sender: str, receiver: str) -> Way:
        """Return how messages of `sender` come to `receiver`."""
        found = self.ways.get((sender, receiver))
        if found is None:
            found = Way(self.delay, self.jitter, self.loss, self.duplication, self.reordering)
            self.ways[sender, receiver] = found
        return found

    def rate_at(self, t: float) -> float:
        """The rate at time `t` [B/s]."""
        return next((rate for since, rate in reversed(self.rates) if t >= since), self.rate)

    def air(self, now: float, size: int) -> float:
        """Put `size` bytes on the air at `now`; return when they have left it."""
        start = max(now, self.busy_until)
        self.busy_until = start + size / self.rate_at(start)
        self.carried += size
        return self.busy_until

    def unicast(self, now: float, size: int, sender: str, receivers: Iterable[str]) -> dict[str, list[float]]:
        """Send one copy to each; return when each receives it: not at all, once, or twice."""
        return {receiver: self._fly(self.air(now, size), sender, receiver) for receiver in receivers}

    def broadcast(self, now: float, size: int, sender: str, receivers: Iterable[str]) -> dict[str, list[float]]:
        """Send once to all; return when each receives it."""
        left = self.air(now, size)
        return {receiver: self._fly(left, sender, receiver) for receiver in receivers}

    def reliable(self, now: float, sender: str, receiver: str) -> float:
        """Return when something arrives that is sent until it does; it is not counted as carried."""
        way, draw = self.way(sender, receiver), self._draw("reliable", sender, receiver)
        lost = 0
        while lost < MOST_TRIES and draw.random() < way.loss:
            lost += 1
        return now + RELIABLE + way.delay + lost * RETRY

    def _fly(self, left: float, sender: str, receiver: str) -> list[float]:
        way, draw = self.way(sender, receiver), self._draw("", sender, receiver)
        fate, twice, overtaken, late = draw.random(), draw.random(), draw.random(), draw.expovariate(1.0)
        if fate < way.loss:
            return []
        arrival = left + way.delay + late * way.jitter
        if overtaken < way.reordering:
            arrival += REORDERED
        else:
            arrival = self._last[sender, receiver] = max(arrival, self._last.get((sender, receiver), -math.inf))
        return [arrival, arrival + REORDERED] if twice < way.duplication else [arrival]

    def _draw(self, kind: str, sender: str, receiver: str) -> Random:
        draw = self._random.get((kind, sender, receiver))
        if draw is None:
            draw = self._random[kind, sender, receiver] = Random(f"{self.seed} {kind} {sender} {receiver}")
        return draw
