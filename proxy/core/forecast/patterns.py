"""What is expected of a stream once it is known how it generates."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from math import floor
from typing import NamedTuple

from proxy.core.forecast.rhythm import Rhythm

MEMORYLESS = "poisson"
"""The kind of what comes at random moments."""


class Span(NamedTuple):
    """The times that are asked for: after `after` and until `until`, at most `most`, as things are at `now` [s]."""

    now: float
    after: float
    until: float
    most: int


class Pattern(ABC):
    """How a stream generates, and in which word (`kind`) robots and people say so.

    `period` is the mean time between samples, or 0.0 when there is none, `jitter` the standard deviation of a
    generation time from what is expected, `pause` the longest time between two samples as the pattern has it [s].
    """

    def __init__(self, kind: str, period: float, jitter: float, pause: float) -> None:
        self.kind = kind
        self.period = period
        self.jitter = jitter
        self.pause = pause

    @abstractmethod
    def expect(self, span: Span) -> list[float]:
        """Return when samples are expected, in order."""


class Periodic(Pattern):
    """One sample every period; `rhythm.number` is the last one seen."""

    def __init__(self, rhythm: Rhythm) -> None:
        super().__init__("periodic", rhythm.period, rhythm.jitter, rhythm.period)
        self.rhythm = rhythm

    def expect(self, span: Span) -> list[float]:
        """Return the times due from the next number on; what is late is not expected any more."""
        rhythm = self.rhythm
        number = max(1, floor((span.after - rhythm.origin) / rhythm.period) + 1)
        # Where the quotient was rounded down. No loop: it would not end where times cannot tell the periods apart.
        number += rhythm.origin + number * rhythm.period <= span.after
        return evenly(rhythm.origin + number * rhythm.period, rhythm.period, span.until, span.most)


class Memoryless(Pattern):
    """Samples at random moments: how long none has come says nothing about the next."""

    def __init__(self, interval: float) -> None:
        super().__init__(MEMORYLESS, interval, interval, interval)

    def expect(self, span: Span) -> list[float]:
        """Return the mean times of the samples to come, from now on."""
        first = max(span.now, span.after) + self.period
        return evenly(first, self.period, span.until, span.most)


def evenly(first: float, step: float, until: float, most: int) -> list[float]:
    """Return at most `most` times from `first` to `until`, `step` apart [s]."""
    count = most if until - first >= most * step else floor((until - first) / step) + 1
    return [first + i * step for i in range(count)]


def merged(runs: Sequence[list[float]], span: Span) -> list[float]:
    """Return the times of all runs that a span asks for, in order."""
    return sorted([t for run in runs for t in run if span.after < t <= span.until])[: span.most]
