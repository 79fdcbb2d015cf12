"""The daemon's place among other processes."""

import ctypes
import os
import platform
import threading

import pytest

from proxy.priority import lengthen_slice, raise_priority

GET_ATTRIBUTES = {"x86_64": 315, "aarch64": 275}
RUNTIME = 3
"""Which eight bytes of what it gives are the slice [ns]."""


def test_threads_that_are_started_later_have_the_place_too():
    """Whether we may or not: where we may not, all stays as it is."""
    before, places = os.getpriority(os.PRIO_PROCESS, 0), []

    def look():
        raised = raise_priority(before - 1)
        started = threading.Thread(target=lambda: places.append(os.getpriority(os.PRIO_PROCESS, 0)))
        started.start()
        started.join()
        places.append(before - 1 if raised else before)

    thread = threading.Thread(target=look)
    thread.start()
    thread.join()
    assert places[0] == places[1]
    assert os.getpriority(os.PRIO_PROCESS, 0) == before


def test_who_is_there_already_stays():
    """A place that the system gave us is not given back."""
    assert raise_priority(os.getpriority(os.PRIO_PROCESS, 0))
    assert raise_priority(os.getpriority(os.PRIO_PROCESS, 0) + 5)


def own_slice():
    """Return the slice of the calling thread [s], as the kernel tells it; 0 where it tells none."""
    attributes = (ctypes.c_uint64 * 6)()
    number = GET_ATTRIBUTES[platform.machine()]
    assert ctypes.CDLL(None).syscall(number, 0, attributes, ctypes.sizeof(attributes), 0) == 0
    return attributes[RUNTIME] / 1e9


@pytest.mark.skipif(platform.machine() not in GET_ATTRIBUTES, reason="another machine")
def test_threads_that_are_started_later_have_the_slice_too():
    """Where the kernel knows of slices; the nice value stays, and other threads keep theirs."""
    before, slices, places = own_slice(), [], []

    def look():
        known = own_slice() > 0.0
        places.append(os.getpriority(os.PRIO_PROCESS, 0))
        assert lengthen_slice(0.006)
        places.append(os.getpriority(os.PRIO_PROCESS, 0))
        started = threading.Thread(target=lambda: slices.append(own_slice()))
        started.start()
        started.join()
        slices.append(0.006 if known else 0.0)

    thread = threading.Thread(target=look)
    thread.start()
    thread.join()
    assert slices[0] == pytest.approx(slices[1])
    assert places[0] == places[1]
    assert own_slice() == before
