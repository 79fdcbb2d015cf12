"""The two clocks of a robot: a monotonic one that drifts, and a wall clock that may be wrong and may step."""

from collections.abc import Iterable
from dataclasses import dataclass
from random import Random

EPOCH = 1.7e9
"""What a right wall clock shows at the start of a flight [s since 1970]."""
BOOT = 1000.0
"""What a monotonic clock shows then, by default [s]."""


@dataclass(frozen=True, slots=True)
class Clock:
    """`offset` is added to the monotonic clock [s], which gains `drift` parts per million.

    The wall clock is wrong by `wall` [s], and by as much as each of the `steps` (true time, seconds) adds from then on.
    Its robot knows that it is wrong by `error` at most [s]; 0.0: it knows nothing.
    """

    offset: float = 0.0
    drift: float = 0.0
    wall: float = 0.0
    steps: tuple[tuple[float, float], ...] = ()
    error: float = 0.0

    def monotonic(self, t: float) -> float:
        """What the monotonic clock shows at true time `t` [s]."""
        return BOOT + self.offset + t * (1.0 + self.drift * 1e-6)

    def true(self, monotonic: float) -> float:
        """Return the true time at which the monotonic clock shows this [s]."""
        return (monotonic - BOOT - self.offset) / (1.0 + self.drift * 1e-6)

    def wall_time(self, t: float) -> float:
        """What the wall clock shows at true time `t` [s]."""
        return EPOCH + self.wall + t + sum(step for at, step in self.steps if t >= at)


def booted_without_time(known_at: float) -> Clock:
    """Return a clock that starts in 1970 and is set right at true time `known_at` [s]."""
    return Clock(wall=-EPOCH, steps=((known_at, EPOCH),))


def synchronised(robots: Iterable[str], error: float, seed: int) -> dict[str, Clock]:
    """Return a clock for every robot that is wrong by `error` at most, as its robot knows [s]."""
    draw = Random(seed)
    return {robot: Clock(wall=draw.uniform(-error, error), error=error) for robot in robots}
