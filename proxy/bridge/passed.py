"""Counts the samples that the core never sees one by one."""

import threading

from proxy.core.interface.events import SamplesPassed

NO_SPEC = "passed:no-spec"
MODE = "passed:mode"
EGRESS = "dropped:egress"
FULL = "dropped:full"
OVERFLOW = "dropped:overflow"
TOO_LARGE = "dropped:too-large"
DENIED = "dropped:denied"
BYPASS = "passed:bypass"
HEARTBEAT = "dropped:heartbeat"


class Passed:
    """Samples and bytes by reason since the last `take`. Bytes are those put on the air, copies counted."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._sums: dict[str, list[int]] = {}

    def add(self, reason: str, size: int) -> None:
        """Count one sample that took `size` bytes of the air."""
        with self._lock:
            sums = self._sums.get(reason)
            if sums is None:
                sums = self._sums[reason] = [0, 0]
            sums[0] += 1
            sums[1] += size

    def take(self, now: float) -> list[SamplesPassed]:
        """Return what was counted, and start again from nothing."""
        if not self._sums:
            return []
        with self._lock:
            sums, self._sums = self._sums, {}
        return [SamplesPassed(now, reason, count, size) for reason, (count, size) in sums.items()]
