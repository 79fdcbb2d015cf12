"""What all robots together put on the air, from the cumulative counts in their digests and our own."""

from collections import deque
from collections.abc import Iterable

from proxy.core.model.limits import Limit

SPAN = 1.0
"""Rates are means over at least this long [s], where the counts come that often."""
MOST = 64
"""Counts remembered of one robot."""
GONE = 5.0
"""A robot not heard for so long puts nothing on the air that we know of [s]."""

_Counts = tuple[float, float, int, int]
"""When we got to know them and when they held [s], messages and bytes, copies counted."""


class Load:
    """Messages and bytes per second on the air."""

    def __init__(self) -> None:
        self._told: dict[str, deque[_Counts]] = {}

    def note(self, now: float, robot: str, at: float, messages: int, size: int) -> None:
        """At `at` on its own clock, a robot had put so many messages of so many bytes in all on the air."""
        told = self._told.setdefault(robot, deque(maxlen=MOST))
        if told and at <= told[-1][1]:
            return
        told.append((now, at, messages, size))
        while len(told) > 2 and told[1][1] <= at - SPAN:
            told.popleft()

    def forget(self, robot: str) -> None:
        """A robot left."""
        self._told.pop(robot, None)

    def parts(self, now: float, limits: Iterable[Limit]) -> tuple[float, ...]:
        """Return the part of each limit that is used."""
        rates = [_rates(told) for told in self._told.values() if told[-1][0] >= now - GONE]
        return tuple(sum(_use(limit, *rate) for rate in rates) * limit.window / limit.limit for limit in limits)


def _rates(told: deque[_Counts]) -> tuple[float, float]:
    (_, t0, messages, size), (_, t1, more, larger) = told[0], told[-1]
    apart = t1 - t0
    return (max(0, more - messages) / apart, max(0, larger - size) / apart) if apart > 0.0 else (0.0, 0.0)


def _use(limit: Limit, messages: float, size: float) -> float:
    """What so many messages of so many bytes in all use in a second, each a transmission of its own."""
    return messages * limit.measure.use(round(size / messages), 1, own=False) if messages > 0.0 else 0.0
