"""Aggregations that specs of the tests name."""

import sys
import threading
from asyncio import CancelledError


class Greatest:
    """The greatest scale received counts."""

    made = 0

    def __init__(self):
        type(self).made += 1

    def empty(self):
        return 0.0

    def add(self, state, message):
        return max(state, message.scale)

    def value(self, state, t_end):
        return state * max(t_end, 0.0)


class Everything(Greatest):
    """Knows every set of messages apart."""

    def empty(self):
        return frozenset()

    def add(self, state, message):
        return state | {message.t_gen}

    def value(self, state, _t_end):
        return float(len(state))


class Slow(Greatest):
    """Comes to no end before it may."""

    may = threading.Event()

    def value(self, state, t_end):
        self.may.wait(30.0)
        return super().value(state, t_end)


class Failing(Greatest):
    def add(self, _state, _message):
        raise RuntimeError("one\ntwo")


class Endless(Greatest):
    def value(self, _state, _t_end):
        return float("inf")


class Listing(Greatest):
    def empty(self):
        return []


class Demanding(Greatest):
    def __init__(self, what):
        self.what = what


class Leaving(Greatest):
    def __init__(self):
        sys.exit("no")


class Cancelled(Greatest):
    def __init__(self):
        raise CancelledError("late")


class Hiding(Greatest):
    """Fails where nobody expects it."""

    @property
    def empty(self):
        raise RuntimeError("one\ntwo")


class Lacking:
    def empty(self):
        return 0.0
