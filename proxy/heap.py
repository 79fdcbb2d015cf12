"""How the C library keeps memory for a daemon: close together, and given back where much of it is not used.

Without the first an idle daemon has 1.5 MB more, and one that passes on four cameras of 40 kB at 10 Hz 1 MB. Without
the second it had 132 MB for good after six applications had published 30 MB each at once; with it 34, a minute later.
"""

import ctypes
import math
import resource
from pathlib import Path

from proxy.tuning import TUNING

_LIBC = ctypes.CDLL(None)
_ARENA_MAX = -8
"""M_ARENA_MAX of <malloc.h>: from how many heaps threads take memory, of which each keeps what is freed there."""


def keep_together() -> None:
    """Have all threads that start from now on take memory from one heap, where the C library is glibc."""
    if hasattr(_LIBC, "mallopt"):
        _LIBC.mallopt(_ARENA_MAX, 1)


def give_back() -> None:
    """Give memory that is not in use back to the system, where the C library is glibc."""
    if hasattr(_LIBC, "malloc_trim"):
        _LIBC.malloc_trim(0)


class Spare:
    """Gives back what was freed and not needed again. That stops who needs memory meanwhile, 50 ms for 300 MB."""

    def __init__(self) -> None:
        self._usual = self._before = _beside_what_is_used()
        self._due = -math.inf

    def look(self, now: float) -> None:
        """Give back what was too much at this look and at the one before."""
        if now < self._due:
            return
        self._due = now + TUNING.spare_looks
        found = _beside_what_is_used()
        if min(found, self._before) > self._usual + TUNING.spare:
            give_back()
            found = self._usual = _beside_what_is_used()
        self._before = found


class _Mallinfo(ctypes.Structure):
    """`struct mallinfo2` of <malloc.h>."""

    _fields_ = tuple(
        (name, ctypes.c_size_t)
        for name in (
            *("arena", "ordblks", "smblks", "hblks", "hblkhd"),
            *("usmblks", "fsmblks", "uordblks", "fordblks", "keepcost"),
        )
    )


def _beside_what_is_used() -> int:
    """Return what the process has of the memory beyond what the C library gave out [B]; 0 where that is not told."""
    if not hasattr(_LIBC, "mallinfo2"):
        return 0
    mallinfo = _LIBC.mallinfo2
    mallinfo.restype = _Mallinfo
    told = mallinfo()
    try:
        _, resident, shared, *_ = map(int, Path("/proc/self/statm").read_text().split())
    except OSError:  # there is no descriptor left
        return 0
    return (resident - shared) * resource.getpagesize() - int(told.uordblks) - int(told.hblkhd)
