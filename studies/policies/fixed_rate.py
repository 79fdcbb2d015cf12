"""A fixed rate for every stream: what a downsampling interceptor of Zenoh does."""

from dataclasses import dataclass, field

from planner import Problem
from studies.policies.simple import whenever_it_fits

ROUNDS = 50
"""Bisections until the interval is known."""


@dataclass(slots=True)
class FixedRate:
    """Send at most one message of a stream per `interval` [s], and only if it fits."""

    interval: float
    _last: dict[int, float] = field(default_factory=dict, init=False)

    def __call__(self, window: Problem) -> bool:
        """Send when the stream's last message lies at least the interval back."""
        message = window.messages[window.current]
        last = self._last.get(message.stream)
        if last is not None and message.t_sent < last + self.interval:
            return False
        send = whenever_it_fits(window)
        if send:
            self._last[message.stream] = message.t_sent
        return send


def filling_interval(mission: Problem) -> float:
    """Return the shortest interval [s] at which all streams of a mission together use no more than the limits.

    A stream that generates more rarely than that sends what it has. 0 when all fits.
    """
    if _fits_at(mission, 0.0):
        return 0.0
    short, long = 0.0, mission.t_end - mission.t_start
    for _ in range(ROUNDS):
        middle = (short + long) / 2
        short, long = (short, middle) if _fits_at(mission, middle) else (middle, long)
    return long


def _fits_at(mission: Problem, interval: float) -> bool:
    """Return whether the limits carry the mean use of all streams, each sending as often as the interval lets it."""
    duration = mission.t_end - mission.t_start
    demand = [0.0] * len(mission.constraints)
    for stream in range(len(mission.streams)):
        own = [m for m in mission.messages if m.stream == stream]
        rate = min(len(own) / duration, 1.0 / interval) if interval > 0 else len(own) / duration
        for k in range(len(demand)):
            demand[k] += rate * sum(m.use[k] for m in own) / max(len(own), 1)
    limits = (constraint.limit / constraint.window for constraint in mission.constraints)
    return all(used <= limit for used, limit in zip(demand, limits, strict=True))
