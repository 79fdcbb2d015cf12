"""When a stream generates its messages: period and phase, estimated on the circle.

The period is the median of recent intervals, each divided by the number of samples it spans, so gaps in what was
seen do not stretch it. The phase is the mean direction of the recent generation times on the circle of one period:
an arithmetic mean of `t mod period` would predict half a period wrong where phases lie near 0.
"""

import math
from collections import deque
from itertools import pairwise
from statistics import median, pstdev

FEW = 8
"""Fewer generation times than these say less of a period than the robot of the stream does."""
MEMORY = 16
"""Generation times looked back on."""


class Schedule:
    """The generation times of one stream, seen through (count, time) pairs."""

    def __init__(self) -> None:
        self._seen: deque[tuple[int, float]] = deque(maxlen=MEMORY)
        self._period = 0.0
        self._shift = 0.0

    @property
    def period(self) -> float:
        """Estimated period [s]; 0.0 while fewer than two generation times are known."""
        return self._period

    @property
    def jitter(self) -> float:
        """Standard deviation of the recent generation times from a regular grid [s]."""
        if len(self._seen) < 3:
            return 0.0
        count, reference = self._seen[-1]
        off = [t - (reference - (count - n) * self._period) - self._shift for n, t in self._seen]
        return pstdev(off)

    @property
    def last(self) -> float | None:
        """The last generation time seen [s]."""
        return self._seen[-1][1] if self._seen else None

    def observe(self, count: int, t_gen: float) -> None:
        """Take in that sample number `count` was generated at `t_gen`; older news is ignored."""
        if self._seen and (count <= self._seen[-1][0] or t_gen <= self._seen[-1][1]):
            return
        self._seen.append((count, t_gen))
        if len(self._seen) > 1:
            self._estimate()

    def assume(self, period: float) -> None:
        """Use `period`, which another robot told us, as long as we saw little of the stream ourselves."""
        if len(self._seen) < FEW and math.isfinite(period) and period > 0.0:
            self._period = period

    def forecast(self, after: float, until: float, most: int) -> list[float]:
        """Generation times expected in (after, until], at most `most` of them, in order."""
        if self.last is None or self._period <= 0.0 or most <= 0:
            return []
        origin = self.last + self._shift
        first = max(1, math.floor((after - origin) / self._period) + 1)
        times: list[float] = []
        while len(times) < most:
            t = origin + first * self._period
            if t > until:
                break
            if t > after:
                times.append(t)
            first += 1
        return times

    def _estimate(self) -> None:
        seen = list(self._seen)
        pairs = pairwise(seen)
        self._period = median((t1 - t0) / (n1 - n0) for (n0, t0), (n1, t1) in pairs)
        reference = seen[-1][1]
        turns = [2.0 * math.pi * (t - reference) / self._period for _, t in seen[-8:]]
        sine, cosine = sum(map(math.sin, turns)), sum(map(math.cos, turns))
        self._shift = math.atan2(sine, cosine) / (2.0 * math.pi) * self._period
