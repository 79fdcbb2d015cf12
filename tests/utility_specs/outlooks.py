"""Functions that specs of tests name: forecasts of features, and schedules."""

import sys
from asyncio import CancelledError


def doubled(_times, values, _t):
    return 2.0 * values[-1]


def endless(_times, _values, _t):
    return float("inf")


def broken(_times, values, _t):
    if values[-1] > 1.0:
        raise ValueError("too much")
    return values[-1]


def every_two(times, until):
    last = times[-1]
    return [last + 2.0 * k for k in range(1, 1 + int((until - last) / 2.0))]


def two_then_nothing(times, until):
    return every_two(times, until) if len(times) <= 3 else 1 / 0


def never_finite(_times, _until):
    return [float("nan")]


def leaving(*_):
    sys.exit("no")


def cancelled(*_):
    raise CancelledError("late")


def interrupted(*_):
    raise KeyboardInterrupt


def no_list(_times, _until):
    return None
