"""How the demo's processes follow its lead: they say when ready, are told when to start, stop on a signal.

The demo reads a line of JSON from a process's standard output once it is ready and writes one to its standard
input. Times are seconds of CLOCK_MONOTONIC, which all processes of a machine share.
"""

import json
import sys
import threading
from collections.abc import Callable
from typing import Any

from proxy.requests import Requests

LONG = 3600.0
"""Whoever waits without end looks this often whether it is over [s]."""


def ready(**facts: Any) -> None:
    """Tell the demo that this process is ready, and what it has to know of it."""
    print(json.dumps(facts), flush=True)


def start_time() -> float:
    """Wait for the demo to say when the run starts; leave when it has gone."""
    line = sys.stdin.readline()
    if not line:
        sys.exit(0)
    return float(json.loads(line))


def listen(take: Callable[[Any], None]) -> None:
    """From now on call `take`, on a thread of its own, with whatever the demo says."""

    def hear() -> None:
        for line in sys.stdin:
            take(json.loads(line))

    threading.Thread(target=hear, daemon=True).start()


def stop_on_signal() -> threading.Event:
    """Return an event that SIGTERM, SIGINT and SIGHUP set, on a thread of its own; called on the main thread."""
    stop, asked = threading.Event(), Requests()

    def hear() -> None:
        while not asked.next(LONG):
            continue
        stop.set()

    threading.Thread(target=hear, daemon=True).start()
    return stop
