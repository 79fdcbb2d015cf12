"""The metrics of the process that every exporter tells, by the names and words that Prometheus' libraries give them.

Their library for Python brings a server, and with it OpenSSL: 7 MB of a daemon, for six lines.
"""

import os
import resource
import time
from collections.abc import Iterator
from pathlib import Path

from proxy import clock

_SELF = Path("/proc/self")
_STARTED = 19
"""When a process started, among the fields of its `stat` behind the name [ticks since the start of the machine]."""
_STEP = 1.0
"""What is more than this is a wall clock that was set, as where a robot boots without one [s]."""


class ProcessMetrics:
    """Those of this process, where the kernel tells them."""

    def __init__(self) -> None:
        fields = (_SELF / "stat").read_text().rpartition(")")[2].split()
        self._since_boot = int(fields[_STARTED]) / os.sysconf("SC_CLK_TCK")
        self._started = self._start()

    def text(self) -> str:
        """Return them as they are now."""
        return "".join(self._lines())

    def _start(self) -> float:
        """Return when the process started, by the wall clock as it is now [s since 1970]."""
        return clock.wall() - time.clock_gettime(time.CLOCK_BOOTTIME) + self._since_boot

    def _lines(self) -> Iterator[str]:
        whole, resident, *_ = map(int, (_SELF / "statm").read_text().split())
        page = resource.getpagesize()
        most, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
        files = sum(1 for _ in (_SELF / "fd").iterdir()) - 1  # without the one that lists them
        yield _metric("virtual_memory_bytes", "gauge", "Virtual memory size in bytes.", whole * page)
        yield _metric("resident_memory_bytes", "gauge", "Resident memory size in bytes.", resident * page)
        started = self._start()
        if abs(started - self._started) > _STEP:  # less would look as if the process had been started anew each time
            self._started = started
        about = "Start time of the process since unix epoch in seconds."
        yield _metric("start_time_seconds", "gauge", about, self._started)
        about = "Total user and system CPU time spent in seconds."
        yield _metric("cpu_seconds_total", "counter", about, time.process_time())
        yield _metric("open_fds", "gauge", "Number of open file descriptors.", files)
        yield _metric("max_fds", "gauge", "Maximum number of open file descriptors.", most)


def _metric(name: str, kind: str, about: str, value: float) -> str:
    return f"# HELP process_{name} {about}\n# TYPE process_{name} {kind}\nprocess_{name} {float(value)!r}\n"
