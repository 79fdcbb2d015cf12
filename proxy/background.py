"""Computes features that take longer than they may, or may never end, on a thread of its own.

Who waits for one does so no longer than he says, and not at all while it hangs.
"""

import math
from collections.abc import Callable
from functools import partial
from threading import Event

from proxy import clock
from proxy.bridge.serial_executor import SerialExecutor
from proxy.tuning import TUNING


class Background(SerialExecutor):
    """Runs one job after the other, in order."""

    def __init__(self) -> None:
        super().__init__("costly features", TUNING.costly_jobs)
        self._began = math.inf
        """When the job in hand was begun [s]."""

    def now(self) -> float:
        """Return the time on our clock [s]."""
        return clock.monotonic()

    def later(self, job: Callable[[], object]) -> bool:
        """Run the job soon; whether there is room for it."""
        return self.offer(job)

    def within(self, patience: float, job: Callable[[], object]) -> bool:
        """Run the job soon, and wait so long for it at most [s]; whether there is room: none while one hangs."""
        if self._hangs(self.now()):
            return False
        done = Event()

        def run() -> None:
            try:
                job()
            finally:
                done.set()

        taken = self.offer(run)
        if taken:
            done.wait(patience)
        return taken

    def insist(self, job: Callable[[], object]) -> None:
        """Do `job` when its turn comes, however many wait."""
        super().insist(partial(self._do, job))

    def _do(self, job: Callable[[], object]) -> None:
        self._began = self.now()
        try:
            job()
        finally:
            self._began = math.inf

    def warnings(self, now: float) -> list[str]:
        """Say when a job takes so long that it may never end."""
        if not self._hangs(now):
            return []
        what = f"a feature takes longer than {TUNING.hangs_after:g} s, and old values of others hold meanwhile"
        return [f"{what}: see functions of your own in the specs"]

    def _hangs(self, now: float) -> bool:
        return now > self._began + TUNING.hangs_after
