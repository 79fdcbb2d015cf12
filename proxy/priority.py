"""The daemon's place among the processes of its robot: before those that compute.

What it does is short, and others wait for it. Beside sixteen busy processes on two cores a thread waits for 10 ms and
more before it runs, and a sample passes five threads.
"""

import os

from proxy.tuning import TUNING


def raise_priority(nice: int = TUNING.niceness) -> bool:
    """Put this thread, and those that it starts from now on, before others; whether we may, or are there already."""
    if os.getpriority(os.PRIO_PROCESS, 0) <= nice:
        return True
    try:
        os.setpriority(os.PRIO_PROCESS, 0, nice)
    except PermissionError:
        return False
    return True
