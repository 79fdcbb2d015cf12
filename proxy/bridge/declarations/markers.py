"""Messages between a main session and its mirror session that say that what was declared before them has come.

Zenoh sends what is declared before all samples that wait, on every link. So who hears a marker has been told
everything that its sender had been told, or had declared itself, before it sent the marker.

A marker that the link does not take within a millisecond is lost (1 of 1,000 where twice as much is to be done as the
machine can): nothing may wait for one without an end.
"""

import secrets
import threading
from collections.abc import Callable

import zenoh

from proxy.bridge.attached import attach
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.declaration import Declaration

Job = Callable[[], object]


class Markers:
    """Markers travel on a `key` of this robot's own, to which nobody else subscribes."""

    def __init__(self, main: zenoh.Session, mirror: zenoh.Session, key: str) -> None:
        self._main, self._mirror, self._key = main, mirror, key
        self._lock = threading.Lock()
        self._jobs: dict[bytes, Job] = {}
        """By the payload of the marker for which each waits: nobody else can know it."""
        handler = zenoh.handlers.Callback(self._come, indirect=False)
        self._subscribers: list[Declaration] = [
            session.declare_subscriber(key, handler, allowed_origin=zenoh.Locality.REMOTE) for session in (main, mirror)
        ]

    def after_told(self, job: Job) -> None:
        """Call `job` when the mirror session has been told of all that is declared to the main session by now."""
        self._send(self._main, job)

    def after_taken(self, job: Job) -> None:
        """Call `job` when the main session knows of all that the mirror session has declared by now."""
        self._send(self._mirror, job)

    def close(self) -> None:
        """Send and hear no more."""
        subscribers, self._subscribers = self._subscribers, []
        for each in subscribers:
            each.undeclare()
        self._jobs.clear()

    def _send(self, session: zenoh.Session, job: Job) -> None:
        number = secrets.token_bytes(8)
        with self._lock:
            while len(self._jobs) >= BOUNDS.markers:  # those were lost
                del self._jobs[next(iter(self._jobs))]
            self._jobs[number] = job
        session.put(
            self._key,
            number,
            priority=zenoh.Priority.REAL_TIME,
            congestion_control=zenoh.CongestionControl.DROP,
            express=True,
            allowed_destination=zenoh.Locality.REMOTE,
        )

    def _come(self, sample: zenoh.Sample) -> None:
        attach()
        with self._lock:
            job = self._jobs.pop(bytes(sample.payload), None)
        if job is not None:
            job()
