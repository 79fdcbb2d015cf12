"""The daemon's clocks. Only drivers read them; the core and the planner are told the time."""

import ctypes
import math
import time
from collections.abc import Callable
from dataclasses import dataclass

from proxy.core.protocol.tuning import TUNING as PROTOCOL
from proxy.tuning import TUNING

_UNSYNCHRONISED = 0x40
"""The kernel's flag of it (STA_UNSYNC)."""

monotonic = time.monotonic
"""Seconds on the clock all decisions are made on."""


def wall() -> float:
    """Seconds since 1970 on the wall clock, the clock of Zenoh's timestamps."""
    return time.time_ns() * 1e-9


def wall_offset() -> float:
    """What the wall clock shows more than the monotonic clock [s]; only a step alters it, for both are slewed alike."""
    return min(_reading() for _ in range(TUNING.wall_clock_readings))[1]


def kernel_error() -> float:
    """What the kernel takes the wall clock to be wrong by at most [s], as chrony told it; infinite when nobody did."""
    shown = _Timex()
    asked = ctypes.CDLL(None).adjtimex(ctypes.byref(shown)) >= 0  # some containers may not ask
    return shown.maxerror * 1e-6 if asked and not shown.status & _UNSYNCHRONISED else math.inf


@dataclass(frozen=True, slots=True)
class Wall:
    """What the wall clock shows more than the monotonic clock, and is wrong by at most; 0.0: nobody knows [s]."""

    offset: float
    error: float


class WallWatch:
    """Notices when somebody sets the wall clock. `offset` is what it showed more than the monotonic clock [s].

    `bound` is what it is wrong by at most while it is synchronised, as the operator says; 0.0: that is not known [s].
    It counts for more while the kernel knows less, whom `kernel` asks.
    """

    def __init__(self, offset: float, bound: float = 0.0, kernel: Callable[[], float] = kernel_error) -> None:
        self._told = Wall(offset, 0.0)
        self._bound = bound
        self._kernel = kernel
        self._due = monotonic() + TUNING.wall_clock_interval
        self._worse_at = -math.inf

    def look(self, now: float) -> Wall | None:
        """Return what is known of the wall clock now if that is news; cheap as a rule."""
        if now < self._due:
            return None
        self._due = now + TUNING.wall_clock_interval
        offset, error = wall_offset(), self._error(now)
        if abs(offset - self._told.offset) < TUNING.wall_clock_step and error == self._told.error:
            return None
        self._told = Wall(offset, error)
        return self._told

    def _error(self, now: float) -> float:
        """In steps of twice as much: what the kernel says grows until it is told anew, and each step is told."""
        if not self._bound:
            return 0.0
        known = min(max(self._kernel(), self._bound), 2.0 * PROTOCOL.clock_error)
        error = self._bound * 2.0 ** math.ceil(math.log2(known / self._bound))
        error, told = error if error <= PROTOCOL.clock_error else 0.0, self._told.error
        if not told or not error or error >= told:
            self._worse_at = now
            return error
        return error if now >= self._worse_at + TUNING.wall_clock_calm else told


def _reading() -> tuple[float, float]:
    """How long it took to read both clocks, and what the wall clock showed more [s]."""
    before = monotonic()
    shown = wall()
    after = monotonic()
    return after - before, shown - (before + after) / 2.0


class _Timex(ctypes.Structure):
    """The begin of the kernel's `struct timex`, and room for its rest."""

    _fields_ = (
        ("modes", ctypes.c_uint),
        ("offset", ctypes.c_long),
        ("freq", ctypes.c_long),
        ("maxerror", ctypes.c_long),
        ("esterror", ctypes.c_long),
        ("status", ctypes.c_int),
        ("rest", ctypes.c_char * 256),
    )
