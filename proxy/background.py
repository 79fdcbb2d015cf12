"""Computes features that take longer than they may: on a thread of its own, on which nothing waits."""

import logging
import threading
from collections import deque
from collections.abc import Callable

from proxy import clock

log = logging.getLogger(__name__)

MOST = 8
"""Jobs that may wait; each holds a sample."""


class Background:
    """Runs one job after the other, in order."""

    def __init__(self) -> None:
        self._jobs: deque[Callable[[], object]] = deque()
        self._wake = threading.Condition()
        self._open = True
        self._thread = threading.Thread(target=self._run, name="costly features", daemon=True)

    def start(self) -> None:
        """Start running jobs."""
        self._thread.start()

    def close(self, timeout: float) -> None:
        """Begin no other job; wait at most `timeout` [s] for the one in hand."""
        with self._wake:
            self._open = False
            self._wake.notify()
        self._thread.join(timeout)

    def now(self) -> float:
        """Return the time on our clock [s]."""
        return clock.monotonic()

    def later(self, job: Callable[[], object]) -> bool:
        """Run the job soon; whether there is room for it."""
        with self._wake:
            if len(self._jobs) >= MOST:
                return False
            self._jobs.append(job)
            self._wake.notify()
            return True

    def _run(self) -> None:
        while True:
            with self._wake:
                while self._open and not self._jobs:
                    self._wake.wait()
                if not self._open:
                    return
                job = self._jobs.popleft()
            try:
                job()
            except Exception:
                log.exception("a feature cannot be computed")
            del job  # or it would keep its sample until the next one comes
