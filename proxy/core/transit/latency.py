"""How long samples take from being sent to being received, by their size: a fixed part, and one per byte.

A robust line: medians of recent samples by classes of sizes, and the weighted median of the slopes between them (after
Theil and Sen; weights by distance, after Jaeckel), never negative.
"""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

from proxy.core.transit.tuning import TUNING


@dataclass(frozen=True, slots=True)
class Latency:
    """Time from sending to receipt: `fixed` [s] and `per_byte` [s/B]."""

    fixed: float
    per_byte: float = 0.0

    def of(self, size: float) -> float:
        """Time that a message of so many bytes takes [s]."""
        return self.fixed + self.per_byte * size


class _Taken(NamedTuple):
    """A message of `size` bytes, received at `at`, took `time` [s]."""

    at: float
    size: float
    time: float


@dataclass(frozen=True, slots=True)
class _Class:
    """Medians of the recent messages of about one size."""

    size: float
    time: float
    count: int


class LatencyFit:
    """The line through what recent messages took. Of each class of sizes some are remembered.

    Several in a row that take far less than others of their size tell that a queue has drained: what was learnt in it
    is forgotten. Without that four robots sent no odometry for 4 s after a queue of 2 s: it would have come too late.
    """

    def __init__(self) -> None:
        self._classes: dict[int, deque[_Taken]] = {}
        """By the number of a class, for those of which something was observed."""
        self._newest = 0.0
        self._since = 0.0
        """What came before counts no more [s]."""
        self._quick: list[float] = []
        """When messages came that were far quicker than others of their size, the last ones in a row [s]."""
        self._line: Latency | None = None
        self._stale = False

    def observe(self, now: float, size: int, time: float) -> None:
        """A message of so many bytes that came at `now` took `time` [s]."""
        number = min(size.bit_length(), TUNING.size_classes - 1)
        taken = self._classes.get(number)
        if taken is None:
            taken = self._classes[number] = deque(maxlen=TUNING.messages_of_a_size)
        self._notice_drained(now, taken, time)
        taken.append(_Taken(now, float(size), time))
        self._newest = now
        self._stale = True

    @property
    def line(self) -> Latency | None:
        """What messages take; None while too few were observed."""
        if self._stale:
            self._line, self._stale = self._fitted(), False
        return self._line

    def _notice_drained(self, now: float, alike: deque[_Taken], time: float) -> None:
        """Take in that a message came at `now`, and whether it was far quicker than those that are `alike` by size."""
        if len(alike) < TUNING.fewest_messages:
            return
        if not far_quicker(time, middle([each.time for each in alike])):
            self._quick.clear()
            return
        self._quick.append(now)
        if len(self._quick) == TUNING.fewest_messages:
            self._since = self._quick[0]

    def _fitted(self) -> Latency | None:
        classes = [_summed_up(taken) for _, each in sorted(self._classes.items()) if (taken := self._recent(each))]
        if sum(each.count for each in classes) < TUNING.fewest_messages:
            return None
        if len(classes) == 1:
            return Latency(classes[0].time)
        slope = _slope([each for each in classes if each.count >= TUNING.fewest_messages])
        fixed = weighted_median((each.time - slope * each.size, float(each.count)) for each in classes)
        if fixed >= 0.0:
            return Latency(fixed, slope)
        return Latency(0.0, weighted_median((each.time / each.size, each.count * each.size) for each in classes))

    def _recent(self, taken: deque[_Taken]) -> deque[_Taken]:
        while taken and taken[0].at < max(self._newest - TUNING.messages_for, self._since):
            taken.popleft()
        return taken


def far_quicker(time: float, usual: float) -> bool:
    """Whether something took so much less than it `usual`ly does that this was learnt in a queue [s]."""
    return time < TUNING.quicker_ratio * usual - TUNING.quicker_by


def middle(values: Iterable[float]) -> float:
    """Return the median. There is at least one; that of `statistics` takes several times as long for a few."""
    ordered = sorted(values)
    half = len(ordered) // 2
    return ordered[half] if len(ordered) % 2 else (ordered[half - 1] + ordered[half]) / 2.0


def weighted_median(values: Iterable[tuple[float, float]]) -> float:
    """Return the median of values with weights; between two that share the middle their mean. There is at least one."""
    ordered = sorted(values)
    half = sum(weight for _, weight in ordered) / 2.0
    passed = 0.0
    for (value, weight), (after, _) in zip(ordered, [*ordered[1:], ordered[-1]], strict=True):
        passed += weight
        if passed == half:
            return (value + after) / 2.0
        if passed > half:
            return value
    return ordered[-1][0]


def _summed_up(taken: deque[_Taken]) -> _Class:
    return _Class(max(1.0, middle([each.size for each in taken])), middle([each.time for each in taken]), len(taken))


def _slope(classes: list[_Class]) -> float:
    """Time per byte [s/B]; 0.0 where sizes are too much alike to tell."""
    slopes = [
        ((large.time - small.time) / (large.size - small.size), large.size - small.size)
        for small, large in combinations(sorted(classes, key=lambda each: each.size), 2)
        if large.size > TUNING.distinct_size_ratio * small.size
    ]
    return max(0.0, weighted_median(slopes)) if slopes else 0.0
