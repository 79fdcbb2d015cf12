"""What is expected of a stream once it is known how it generates."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor
from typing import NamedTuple, Protocol

from proxy.core.forecast.rhythm import Rhythm

MEMORYLESS = "poisson"
"""The kind of what comes at random moments."""


class Span(NamedTuple):
    """The times that are asked for: after `after` and until `until`, at most `most`, as things are at `now` [s]."""

    now: float
    after: float
    until: float
    most: int


class Pattern(Protocol):
    """How a stream generates. `period` is the mean time between samples, `jitter` its standard deviation [s]."""

    @property
    def kind(self) -> str:
        """The word that robots and people use for it."""

    @property
    def period(self) -> float:
        """Mean time between samples [s]; 0.0 when there is none."""

    @property
    def jitter(self) -> float:
        """Standard deviation of a generation time from what is expected [s]."""

    @property
    def pause(self) -> float:
        """The longest time between two samples as the pattern has it [s]."""

    def expect(self, span: Span) -> list[float]:
        """Return when samples are expected, in order."""


class Periodic(NamedTuple):
    """One sample every period; `rhythm.number` is the last one seen."""

    rhythm: Rhythm

    @property
    def kind(self) -> str:
        """`periodic`."""
        return "periodic"

    @property
    def period(self) -> float:
        """The period [s]."""
        return self.rhythm.period

    @property
    def jitter(self) -> float:
        """The jitter [s]."""
        return self.rhythm.jitter

    @property
    def pause(self) -> float:
        """One period [s]."""
        return self.rhythm.period

    def expect(self, span: Span) -> list[float]:
        """Return the times due from the next number on; what is late is not expected any more."""
        rhythm = self.rhythm
        number = max(1, floor((span.after - rhythm.origin) / rhythm.period) + 1)
        # Where the quotient was rounded down. No loop: it would not end where times cannot tell the periods apart.
        number += rhythm.origin + number * rhythm.period <= span.after
        return evenly(rhythm.origin + number * rhythm.period, rhythm.period, span.until, span.most)


@dataclass(frozen=True, slots=True)
class Memoryless:
    """Samples at random moments: how long none has come says nothing about the next."""

    interval: float

    @property
    def kind(self) -> str:
        """`poisson`."""
        return MEMORYLESS

    @property
    def period(self) -> float:
        """The mean interval [s]."""
        return self.interval

    @property
    def jitter(self) -> float:
        """That of an exponential distribution is its mean [s]."""
        return self.interval

    @property
    def pause(self) -> float:
        """The mean interval [s]."""
        return self.interval

    def expect(self, span: Span) -> list[float]:
        """Return the mean times of the samples to come, from now on."""
        now = max(span.now, span.after)
        return evenly(now + self.interval, self.interval, span.until, span.most)


def evenly(first: float, step: float, until: float, most: int) -> list[float]:
    """Return at most `most` times from `first` to `until`, `step` apart [s]."""
    count = most if until - first >= most * step else floor((until - first) / step) + 1
    return [first + i * step for i in range(count)]


def merged(runs: Sequence[list[float]], span: Span) -> list[float]:
    """Return the times of all runs that a span asks for, in order."""
    return sorted([t for run in runs for t in run if span.after < t <= span.until])[: span.most]
