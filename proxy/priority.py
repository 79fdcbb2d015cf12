"""The daemon's place among the processes of its robot: before those that compute.

What it does is short, and others wait for it. Beside sixteen busy processes on two cores a thread waits for 10 ms and
more before it runs, and a sample passes five threads.
"""

import ctypes
import os
import platform

from proxy.tuning import TUNING

_LIBC = ctypes.CDLL(None)
_SET_ATTRIBUTES = {"x86_64": 314, "aarch64": 274}
"""sched_setattr(2) of <asm/unistd.h>, by machine."""


class _Attributes(ctypes.Structure):
    """struct sched_attr of <linux/sched/types.h>; policy 0 is the usual one."""

    _fields_ = (
        ("size", ctypes.c_uint32),
        ("policy", ctypes.c_uint32),
        ("flags", ctypes.c_uint64),
        ("nice", ctypes.c_int32),
        ("priority", ctypes.c_uint32),
        ("runtime", ctypes.c_uint64),
        ("deadline", ctypes.c_uint64),
        ("period", ctypes.c_uint64),
    )


def raise_priority(nice: int = TUNING.niceness) -> bool:
    """Put this thread, and those that it starts from now on, before others; whether we may, or are there already."""
    if os.getpriority(os.PRIO_PROCESS, 0) <= nice:
        return True
    try:
        os.setpriority(os.PRIO_PROCESS, 0, nice)
    except PermissionError:
        return False
    return True


def lengthen_slice(seconds: float = TUNING.slice) -> bool:
    """Have this thread, and those that it starts from now on, not give way to others within one decision [s].

    Its part of the processor stays as it is. Return whether the kernel took note; before Linux 6.12 it makes nothing of
    it. For who comes before others: who does not would wait longer for its turn.
    """
    number = _SET_ATTRIBUTES.get(platform.machine())
    if number is None or os.sched_getscheduler(0) != os.SCHED_OTHER:
        return False
    size, nice, runtime = ctypes.sizeof(_Attributes), os.getpriority(os.PRIO_PROCESS, 0), round(seconds * 1e9)
    wanted = _Attributes(size, os.SCHED_OTHER, 0, nice, 0, runtime, 0, 0)
    return bool(_LIBC.syscall(number, 0, ctypes.byref(wanted), 0) == 0)
