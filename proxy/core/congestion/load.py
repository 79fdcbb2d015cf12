"""What all robots together put on the air, from the cumulative counts in their digests and our own."""

from collections import deque
from collections.abc import Iterable

from proxy.core.congestion.tuning import TUNING
from proxy.core.model.limits import Limit

_Counts = tuple[float, float, int, int]
"""When we got to know them and when they held [s], messages and bytes, copies counted."""


class Load:
    """Messages and bytes per second on the air."""

    def __init__(self) -> None:
        self._reported: dict[str, deque[_Counts]] = {}

    def note(self, now: float, robot: str, at: float, messages: int, size: int) -> None:
        """At `at` on its own clock, a robot had put so many messages of so many bytes in all on the air."""
        counts = self._reported.setdefault(robot, deque(maxlen=TUNING.remembered))
        if counts and at <= counts[-1][1]:
            return
        counts.append((now, at, messages, size))
        while len(counts) > 2 and counts[1][1] <= at - TUNING.rate_span:
            counts.popleft()

    def forget(self, robot: str) -> None:
        """A robot left."""
        self._reported.pop(robot, None)

    def parts(self, now: float, limits: Iterable[Limit]) -> tuple[float, ...]:
        """Return the part of each limit that is used."""
        rates = [_rates(counts) for counts in self._reported.values() if counts[-1][0] >= now - TUNING.lifetime]
        return tuple(sum(_use(limit, *rate) for rate in rates) * limit.window / limit.limit for limit in limits)


def _rates(counts: deque[_Counts]) -> tuple[float, float]:
    (_, t0, messages, size), (_, t1, more, larger) = counts[0], counts[-1]
    apart = t1 - t0
    return (max(0, more - messages) / apart, max(0, larger - size) / apart) if apart > 0.0 else (0.0, 0.0)


def _use(limit: Limit, messages: float, size: float) -> float:
    """What so many messages of so many bytes in all use in a second, each a transmission of its own."""
    return messages * limit.measure.use(round(size / messages), 1, own=False) if messages > 0.0 else 0.0
