"""The daemon's clocks. Only drivers read them; the core and the planner are told the time."""

import time

monotonic = time.monotonic
"""Seconds on the clock all decisions are made on."""


def wall() -> float:
    """Seconds since 1970 on the wall clock, the clock of Zenoh's timestamps."""
    return time.time_ns() * 1e-9
