"""The daemon's clocks. Only drivers read them; the core and the planner are told the time."""

import time

PACE = 1.0
"""Time between two looks at what the wall clock shows [s]."""
STEP = 1e-3
"""Less than this is no step of the wall clock [s]."""
_READINGS = 5

monotonic = time.monotonic
"""Seconds on the clock all decisions are made on."""


def wall() -> float:
    """Seconds since 1970 on the wall clock, the clock of Zenoh's timestamps."""
    return time.time_ns() * 1e-9


def wall_offset() -> float:
    """What the wall clock shows more than the monotonic clock [s]; only a step alters it, for both are slewed alike."""
    return min(_reading() for _ in range(_READINGS))[1]


class WallWatch:
    """Notices when somebody sets the wall clock. `offset` is what it showed more than the monotonic clock [s]."""

    def __init__(self, offset: float) -> None:
        self._offset = offset
        self._due = monotonic() + PACE

    def look(self, now: float) -> float | None:
        """Return what the wall clock now shows more than the monotonic clock if that is news; cheap as a rule."""
        if now < self._due:
            return None
        self._due = now + PACE
        offset = wall_offset()
        if abs(offset - self._offset) < STEP:
            return None
        self._offset = offset
        return offset


def _reading() -> tuple[float, float]:
    """How long it took to read both clocks, and what the wall clock showed more [s]."""
    before = monotonic()
    shown = wall()
    after = monotonic()
    return after - before, shown - (before + after) / 2.0
