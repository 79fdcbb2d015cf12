"""The daemon's place among other processes."""

import os
import threading

from proxy.priority import raise_priority


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
