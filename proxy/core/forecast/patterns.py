"""What is expected of a stream once it is known how it generates: by a rhythm, at random, or in bursts."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from itertools import pairwise
from math import floor
from typing import NamedTuple

from proxy.core.forecast.rhythm import Numbered, Rhythm, fit
from proxy.core.forecast.tuning import TUNING

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

    def ahead(self, span: Span, at_last: float) -> list[float]:
        """Return the same; where that is never the first time until `at_last` [s], if there is one."""
        return self.expect(span) or self.expect(Span(span.now, span.after, at_last, 1))


class Even(Pattern):
    """One sample every period."""

    @abstractmethod
    def first(self, span: Span) -> float:
        """Return the first time after that of a span [s]."""

    def expect(self, span: Span) -> list[float]:
        """Return the times one period apart."""
        return evenly(self.first(span), self.period, span.until, span.most)

    def ahead(self, span: Span, at_last: float) -> list[float]:
        """Return the same, and look for the first one only once: a window asks this of each of 60 streams."""
        first = self.first(span)
        if first > span.until:
            return [first] if first <= at_last else []
        return evenly(first, self.period, span.until, span.most)


class Periodic(Even):
    """One sample every period; `rhythm.number` is the last one seen."""

    def __init__(self, rhythm: Rhythm) -> None:
        super().__init__("periodic", rhythm.period, rhythm.jitter, rhythm.period)
        self.rhythm = rhythm

    def first(self, span: Span) -> float:
        """Return when the next number is due; what is late is not expected any more."""
        rhythm = self.rhythm
        number = max(1, floor((span.after - rhythm.origin) / rhythm.period) + 1)
        # Where the quotient was rounded down. No loop: it would not end where times cannot tell the periods apart.
        number += rhythm.origin + number * rhythm.period <= span.after
        return rhythm.origin + number * rhythm.period


class Memoryless(Even):
    """Samples at random moments: how long none has come says nothing about the next."""

    def __init__(self, interval: float) -> None:
        super().__init__(MEMORYLESS, interval, interval, TUNING.random_gap * interval)

    def first(self, span: Span) -> float:
        """Return the mean time of the next sample, from now on."""
        return max(span.now, span.after) + self.period


def evenly(first: float, step: float, until: float, most: int) -> list[float]:
    """Return at most `most` times from `first` to `until`, `step` apart [s]."""
    count = most if until - first >= most * step else floor((until - first) / step) + 1
    return [first + i * step for i in range(count)]


def merged(runs: Sequence[list[float]], span: Span) -> list[float]:
    """Return the times of all runs that a span asks for, in order."""
    return sorted([t for run in runs for t in run if span.after < t <= span.until])[: span.most]


class Bursts(Pattern):
    """`size` samples every `step` [s], and that whenever a burst starts; `begun` samples of the last one are known."""

    def __init__(self, starts: Rhythm, size: int, step: float, last: float, begun: int) -> None:
        super().__init__(f"bursts {size} {step:.6g}", starts.period / size, starts.jitter, starts.period)
        self.starts = starts
        self.size = size
        self.step = step
        self.last = last
        self.begun = begun

    def joined(self, t: float) -> "Bursts | None":
        """Return the bursts with one more sample at `t` [s] in the last one; None when it is none of it."""
        if t > self.last + TUNING.burst_pause * self.step or self.begun >= TUNING.burst_sizes * self.size:
            return None
        return Bursts(self.starts, self.size, self.step, t, self.begun + 1)

    def expect(self, span: Span) -> list[float]:
        """Return what is missing of the last burst, and the members of those to come."""
        rest = evenly(self.last + self.step, self.step, span.until, self.size - self.begun)
        since = Span(span.now, max(span.after, self.last), span.until, span.most // self.size + 2)
        regular = self.starts.looseness <= TUNING.no_rhythm
        starts = (Periodic(self.starts) if regular else Memoryless(self.starts.period)).expect(since)
        return merged([rest, *(evenly(t, self.step, span.until, self.size) for t in starts)], span)


def bursts_in(past: Sequence[Numbered], *, whole: bool) -> Bursts | None:
    """Return the bursts in numbered times; None when there are none. `whole` says that the first one is complete."""
    times = [t for _, t in past]
    gaps = [b - a for a, b in pairwise(times)]
    longest_step = _longest_step(gaps)
    if longest_step is None:
        return None
    heads = [0, *(i + 1 for i, gap in enumerate(gaps) if gap > longest_step)]
    rest = past[-1][0] - past[heads[-1]][0] + 1
    sizes = [past[b][0] - past[a][0] for a, b in pairwise(heads)][0 if whole else 1 :]
    size = round(sum(sizes) / max(1, len(sizes)))
    few = len(sizes) < TUNING.run and max(*sizes, rest, heads[1]) > TUNING.burst_sizes * min(sizes, default=0)
    starts = fit([(i, times[head]) for i, head in enumerate(heads)][0 if whole else 1 :])
    endless = rest > TUNING.burst_sizes * max(sizes, default=0)
    if starts is None or size < 2 or few or endless:
        return None
    steps = sorted([gap for gap in gaps if gap <= longest_step])
    return Bursts(starts, size, steps[len(steps) // 2], times[-1], rest)


def reported_bursts(words: Sequence[str], period: float, last: float) -> Bursts | None:
    """Return the bursts of which a robot reported size and step, as `Bursts.kind` writes them; None for nonsense."""
    try:
        size, step = int(words[1]), float(words[2])
    except (IndexError, ValueError):
        return None
    if not (2 <= size <= TUNING.most_members and 0.0 < step < period):
        return None
    return Bursts(Rhythm(size * period, last - (size - 1) * step, 1, 0.0, 1), size, step, last, size)


def _longest_step(gaps: Sequence[float]) -> float | None:
    """Return the longest of the short gaps, where short and long ones are far apart and half at least are short."""
    ordered = sorted(gaps)
    best, found = TUNING.burst_pause, None
    for i in range((len(ordered) - 1) // 2, len(ordered) - 2):
        if ordered[i + 1] >= best * ordered[i]:
            best, found = ordered[i + 1] / ordered[i], ordered[i]
    return found
