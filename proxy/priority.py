"""The daemon's place among the processes of its robot: before those that compute.

What it does is short, and others wait for it. Beside sixteen busy processes on two cores a thread waits for 10 ms and
more before it runs, and a sample passes five threads.
"""

import os

NICE = -10
"""The niceness of the daemon where it may choose: ten times the weight of a usual process."""


def raise_priority(nice: int = NICE) -> bool:
    """Put this thread, and those that it starts from now on, before others; whether we may, or are there already."""
    if os.getpriority(os.PRIO_PROCESS, 0) <= nice:
        return True
    try:
        os.setpriority(os.PRIO_PROCESS, 0, nice)
    except PermissionError:
        return False
    return True
