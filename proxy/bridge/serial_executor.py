"""A thread that does small jobs in order, so that no Zenoh callback has to wait for the other side."""

import logging
import threading
from collections import deque
from collections.abc import Callable

import zenoh

from proxy.bridge.bounds import BOUNDS

log = logging.getLogger(__name__)


class SerialExecutor:
    """Runs jobs in order. `offer` refuses when `most` wait; `insist`, for what must be done, does not.

    The thread starts with the first job: most daemons have executors that never get one.
    """

    def __init__(self, name: str, most: int = BOUNDS.jobs) -> None:
        self._most = most
        self._jobs: deque[Callable[[], object]] = deque()
        lock = threading.Lock()
        self._wake, self._room = threading.Condition(lock), threading.Condition(lock)
        self._open = True
        self._done, self._stuck_at = 0, -1
        """How many jobs were done, and how many when somebody waited for one in vain."""
        self._waiting = 0
        """Threads that wait for room."""
        self.refused = 0
        self._name = name
        self._thread: threading.Thread | None = None

    def offer(self, job: Callable[[], object]) -> bool:
        """Do `job` when its turn comes; whether there was room."""
        if len(self._jobs) >= self._most:
            self.refused += 1
            return False
        self.insist(job)
        return True

    def await_room(self, patience: float) -> None:
        """Wait until fewer jobs wait, but no longer than so [s]: for who brings more than can be done, and may wait.

        Where that was in vain nobody waits again until something was done: that thread is stuck. Nor does anybody wait
        where too many do.
        """
        if len(self._jobs) < self._most or self._done == self._stuck_at:
            return
        with self._room:
            if self._waiting >= BOUNDS.waiting_for_jobs:
                return
            self._waiting += 1
            if not self._room.wait_for(lambda: len(self._jobs) < self._most or not self._open, patience):
                self._stuck_at = self._done
            self._waiting -= 1

    def insist(self, job: Callable[[], object]) -> None:
        """Do `job` when its turn comes, however many wait."""
        with self._wake:
            self._jobs.append(job)
            if self._thread is None and self._open:
                self._thread = threading.Thread(target=self._run, name=self._name, daemon=True)
                self._thread.start()
            self._wake.notify()

    def close(self, timeout: float) -> None:
        """Stop after the job in hand; wait for it at most `timeout` [s]."""
        with self._wake:
            self._open = False
            self._wake.notify()
            self._room.notify_all()
        if self._thread is not None:
            self._thread.join(timeout)

    def _run(self) -> None:
        while True:
            with self._wake:
                while self._open and not self._jobs:
                    self._wake.wait()
                if not self._open:
                    return
                job = self._jobs.popleft()
                self._room.notify_all()
            self._done += 1
            try:
                job()
            except zenoh.ZError as error:
                log.warning("%s: %s", self._name, error)
            except Exception:
                log.exception("%s: a job failed", self._name)
            del job  # or it would keep what it holds until the next one comes
