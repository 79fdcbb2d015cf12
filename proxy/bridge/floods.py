"""What others say and is not taken in: counted, told to the core now and then, and said loudly when it is a flood."""

import logging
import threading
from collections import Counter
from collections.abc import Callable
from typing import Any

from proxy.bridge.bounds import BOUNDS
from proxy.bridge.budget import Bucket
from proxy.core.interface.events import MalformedHeard

log = logging.getLogger(__name__)


class Floods:
    """Counts by kind, as the core does: what it was, a colon, and what was wrong. From any thread.

    `offer` gets a `MalformedHeard` for each of a few messages, and for all of a flood now and then.
    """

    def __init__(self, offer: Callable[[MalformedHeard], object]) -> None:
        self._offer = offer
        self._lock = threading.Lock()
        self._buckets: dict[str, Bucket] = {}
        self._waiting: Counter[str] = Counter()
        """What the core was not told of yet."""
        self._counts: Counter[str] = Counter()
        self._last: dict[str, float] = {}
        self._said: dict[str, tuple[float, int]] = {}
        """When a flood of each kind was last said [s], and how much it had come to."""

    def refuse(self, now: float, robot: str, kind: str) -> None:
        """A message on a key of `robot` is not taken in."""
        with self._lock:
            bucket = self._buckets.get(kind)
            if bucket is None:
                bucket = self._buckets[kind] = Bucket(now, BOUNDS.flood, BOUNDS.flood_at_once)
            self._waiting[kind] += 1
            if bucket.take(now):
                self._tell(now, robot, kind)
            else:
                self._flood(now, robot, kind)

    def flush(self, now: float) -> None:
        """Tell the core of all of it."""
        with self._lock:
            for kind in list(self._waiting):
                self._tell(now, "", kind)

    def describe(self, now: float) -> dict[str, Any]:
        """Return what the status says: of each kind how many were too many so far, and when the last one came [s]."""
        with self._lock:
            return {
                kind: {"messages": count, "age": now - self._last[kind]} for kind, count in sorted(self._counts.items())
            }

    def warnings(self, now: float) -> list[str]:
        """Name the floods of the last minute."""
        return [
            f"a flood on Sendworthy's own keys: {each['messages']} messages too many so far ({kind})"
            for kind, each in self.describe(now).items()
            if each["age"] < BOUNDS.warnings_apart
        ]

    def _tell(self, now: float, robot: str, kind: str) -> None:
        self._offer(MalformedHeard(now, robot, kind, self._waiting.pop(kind)))

    def _flood(self, now: float, robot: str, kind: str) -> None:
        self._counts[kind] += 1
        self._last[kind] = now
        said_at, said = self._said.get(kind, (now - BOUNDS.warnings_apart, 0))
        if now - said_at >= BOUNDS.warnings_apart:
            count = self._counts[kind]
            self._said[kind] = now, count
            log.warning(
                "a flood on keys of robot %.64r: %s, %d too many since it was last said",
                *(robot, kind, count - said),
                extra={"reason": kind, "new": count - said, "total": count},
            )
