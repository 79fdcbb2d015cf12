"""Keeps Zenoh's threads known to Python from one callback to the next.

A callback comes on a thread of Zenoh's runtime. Python makes a state for such a thread when it enters and throws it
away when it leaves, and with it memory that it maps and unmaps each time: most of what a small sample would cost. One
reference that is never given back keeps the state; there are no more of them than Zenoh has threads.
"""

import ctypes
import threading

_attached: set[int] = set()


def attach() -> None:
    """Keep this thread's state from now on. Called at the beginning of callbacks that come for every sample."""
    thread = threading.get_ident()
    if thread not in _attached:
        _attached.add(thread)
        ctypes.pythonapi.PyGILState_Ensure()
