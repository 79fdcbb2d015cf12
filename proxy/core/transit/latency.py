"""How long samples take from being sent to being received, by their size: a fixed part, and one per byte.

A robust line through recent samples of all sizes: the median slope of pairs that are half of them apart in size (after
Theil and Sen), never negative, and the median of what is left.
"""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
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


class LatencyFit:
    """The line through what recent messages took. Of each class of sizes some are remembered."""

    def __init__(self) -> None:
        self._classes: dict[int, deque[_Taken]] = {}
        """By the number of a class, for those of which something was observed."""
        self._newest = 0.0
        self._line: Latency | None = None
        self._stale = False

    def observe(self, now: float, size: int, time: float) -> None:
        """A message of so many bytes that came at `now` took `time` [s]."""
        number = min(size.bit_length(), TUNING.size_classes - 1)
        taken = self._classes.get(number)
        if taken is None:
            taken = self._classes[number] = deque(maxlen=TUNING.messages_of_a_size)
        taken.append(_Taken(now, float(size), time))
        self._newest = now
        self._stale = True

    @property
    def line(self) -> Latency | None:
        """What messages take; None while too few were observed."""
        if self._stale:
            self._line, self._stale = self._fitted(), False
        return self._line

    def _fitted(self) -> Latency | None:
        taken = sorted([(each.size, each.time) for of in self._classes.values() for each in self._recent(of)])
        if len(taken) < TUNING.fewest_messages:
            return None
        slopes = [
            (time - sooner) / (large - small)
            for (small, sooner), (large, time) in zip(taken, taken[len(taken) // 2 :], strict=False)
            if large > TUNING.distinct_size_ratio * small
        ]
        slope = max(0.0, middle(slopes)) if len(slopes) >= TUNING.fewest_messages else 0.0
        return Latency(max(0.0, middle([time - slope * size for size, time in taken])), slope)

    def _recent(self, taken: deque[_Taken]) -> deque[_Taken]:
        while taken and taken[0].at < self._newest - TUNING.messages_for:
            taken.popleft()
        return taken


def middle(values: Iterable[float]) -> float:
    """Return the median. There is at least one; that of `statistics` takes several times as long for a few."""
    ordered = sorted(values)
    half = len(ordered) // 2
    return ordered[half] if len(ordered) % 2 else (ordered[half - 1] + ordered[half]) / 2.0
