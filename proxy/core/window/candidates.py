"""The streams that compete in a window, the messages that are expected of each, and what they are guaranteed.

A sample is *owed* when its stream would else be without one for too long. Plans take those to come for sent.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from heapq import heapify, heappop, heapreplace

from planner import Aggregation
from proxy.core.view.audience import Audience
from proxy.core.view.stream import Stream, at_stake
from proxy.core.window.tuning import TUNING


def guaranteed(stream: Stream) -> bool:
    """Whether a stream is guaranteed anything."""
    return stream.information_type.guarantee.rate > 0.0


def longest(stream: Stream, latency: float) -> float:
    """How far apart samples may be generated that are sent, at a latency [s]; without end where nothing is said."""
    guarantee = stream.information_type.guarantee
    rate = 1.0 / guarantee.min_rate if guarantee.min_rate else math.inf
    age = max(0.0, guarantee.max_age - latency) if guarantee.max_age else math.inf
    return min(rate, age)


def owed(stream: Stream, times: Iterable[float], latency: float) -> Iterator[float]:
    """Yield those generation times of samples [s] that must be sent."""
    apart, ahead = longest(stream, latency), (1.0 - TUNING.early) * stream.schedule.period
    before = -math.inf if stream.sent is None else stream.sent.t_gen
    for t in times:
        if t + ahead - before > apart:
            yield t
            before = t


@dataclass(slots=True)
class Candidate:
    """A stream that competes, number `place` of the problem; its samples go in so many `copies` to its `audience`."""

    stream: Stream
    place: int
    copies: int
    audience: Audience
    own: bool
    markovian: bool
    size: int = 0
    """The size that its samples to come are planned with [B]."""
    copy: bool = False
    """Whether these are messages for one robot alone, which was away when they were generated."""
    times: list[float] = field(default_factory=list)
    """When it is expected to generate [s]."""

    @property
    def worth(self) -> float:
        """Value per byte on the air."""
        last = self.stream.newest
        return at_stake(self.stream, last.scale) * self.audience.share / max(last.size * self.copies, 1)

    @property
    def standard(self) -> bool:
        """Whether the aggregation is the planner's own, not a model of the operator's."""
        return isinstance(self.stream.information_type.aggregation, Aggregation)

    def expect(self, times: list[float], size: int | None = None) -> None:
        """Its samples are expected at these times [s], of that size [B] if it is given."""
        self.times = times
        self.size = self.size if size is None else size

    def take_owed(self) -> list[float]:
        """Take what its guarantee demands out of the times; return it."""
        times = list(owed(self.stream, self.times, self.audience.slowest))
        self.times = [t for t in self.times if t not in times]
        return times

    def bound(self, end: float) -> None:
        """Expect nothing after `end` [s], and no more than it does not take too long to weigh."""
        if self.times and self.times[-1] > end:
            self.times = [t for t in self.times if t <= end]
        if self.markovian or (self.standard and self.stream.information_type.aggregation is not Aggregation.BEST):
            return
        while len(self.times) > (TUNING.forecasts_of_best if self.standard else TUNING.messages_of_a_model):
            self.halve()

    def halve(self) -> int:
        """Leave out every other time; return how many that are."""
        before = len(self.times)
        self.times = self.times[::2]
        return before - len(self.times)


def thin(candidates: list[Candidate], most: int) -> None:
    """Halve the forecasts that are worth least each until there are at most so many, or one of each stream."""
    excess = sum([len(c.times) for c in candidates]) - most
    if excess <= 0:
        return
    left = [(c.worth / len(c.times), c.place, c) for c in candidates if len(c.times) > 1]
    heapify(left)
    while excess > 0 and left:
        _, place, thickest = left[0]
        excess -= thickest.halve()
        if len(thickest.times) > 1:
            heapreplace(left, (thickest.worth / len(thickest.times), place, thickest))
        else:
            heappop(left)
