"""Room for samples that wait in the bridge, bounded in samples and bytes."""

import threading
from dataclasses import dataclass

from proxy.bridge.tuning import TUNING


class Room:
    """Lets samples in while there is a place. From any thread.

    One counts as at most half of the bytes, so that one of any size finds a place.
    """

    def __init__(self, most: int, most_bytes: int) -> None:
        self.most = most
        self.most_bytes = most_bytes
        self.samples = self.bytes = 0
        """What waits."""
        self._counted = 0
        self._lock = threading.Lock()  # taken itself for every sample: a condition's methods are Python
        self._left = threading.Condition(self._lock)
        self._waiting = 0

    @property
    def crowded(self) -> bool:
        """Whether more than half of it is taken."""
        return self.samples > self.most // 2 or self._counted > self.most_bytes // 2

    def enter(self, size: int) -> bool:
        """Take a place for a sample of `size` bytes, if there is one."""
        counted = min(size, self.most_bytes // 2)
        with self._lock:
            if self.samples >= self.most or self._counted + counted > self.most_bytes:
                return False
            self.samples += 1
            self.bytes += size
            self._counted += counted
            return True

    def leave(self, size: int) -> None:
        """Give back the place of a sample of `size` bytes."""
        with self._lock:
            self.samples -= 1
            self.bytes -= size
            self._counted -= min(size, self.most_bytes // 2)
            if self._waiting and not self.crowded:
                self._left.notify_all()

    def linger(self, size: int) -> None:
        """Let others leave before a sample of `size` bytes comes, while it is crowded: for a moment at most."""
        with self._left:
            self._waiting += 1
            self._left.wait_for(lambda: not self.crowded, TUNING.catch_up * (1 + size // 65536))
            self._waiting -= 1

    def describe(self) -> dict[str, int]:
        """Return what the status says: what waits."""
        return {"samples": self.samples, "bytes": self.bytes}


@dataclass(frozen=True, slots=True)
class Rooms:
    """Where samples wait: those to be decided, until they are handed over or dropped, and those that only pass."""

    covered: Room
    passing: Room

    def describe(self) -> dict[str, dict[str, int]]:
        """Return what the status says."""
        most = {"samples": self.covered.most, "bytes": self.covered.most_bytes}
        return {"covered": self.covered.describe(), "passing": self.passing.describe(), "most": most}


def rooms(samples: int, size: int) -> Rooms:
    """Return rooms of these bounds [samples, B], one for each kind."""
    return Rooms(Room(samples, size), Room(samples, size))
