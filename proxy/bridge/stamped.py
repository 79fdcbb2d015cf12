"""The samples that got our stamp lately: one of them that comes again left for the mesh, and came around the daemons.

The stamp alone does not tell: applications publish with the timestamp of what they heard, too, under another key.
"""

import threading

import zenoh

from proxy.bridge.bounds import BOUNDS


class Stamped:
    """Remembers keys and timestamps. From any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._newer: set[tuple[str, zenoh.Timestamp]] = set()
        self._older: set[tuple[str, zenoh.Timestamp]] = set()

    def note(self, key: str, stamp: zenoh.Timestamp) -> None:
        """A sample of `key` leaves with this stamp of ours."""
        newer = self._newer
        newer.add((key, stamp))
        if len(newer) >= BOUNDS.stamped_samples:
            with self._lock:
                if newer is self._newer:
                    self._older, self._newer = newer, set()

    def holds(self, key: str, stamp: zenoh.Timestamp) -> bool:
        """Whether a sample of `key` left with this stamp."""
        return (key, stamp) in self._newer or (key, stamp) in self._older
