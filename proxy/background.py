"""Computes features that take longer than they may: on a thread of its own, on which nothing waits."""

from collections.abc import Callable
from threading import Event

from proxy import clock
from proxy.bridge.serial_executor import SerialExecutor
from proxy.tuning import TUNING


class Background(SerialExecutor):
    """Runs one job after the other, in order."""

    def __init__(self) -> None:
        super().__init__("costly features", TUNING.costly_jobs)

    def now(self) -> float:
        """Return the time on our clock [s]."""
        return clock.monotonic()

    def later(self, job: Callable[[], object]) -> bool:
        """Run the job soon; whether there is room for it."""
        return self.offer(job)

    def within(self, patience: float, job: Callable[[], object]) -> bool:
        """Run the job soon, whatever waits, and wait so long for it at most [s]; whether it was done by then."""
        done = Event()

        def run() -> None:
            try:
                job()
            finally:
                done.set()

        self.insist(run)
        return done.wait(patience)
