"""Images as they come from robots: how often, how old, and passed on untouched."""

import json
import math
import struct
import threading
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import zenoh

from proxy import clock
from proxy.page.tuning import TUNING

KINDS: Mapping[bytes, str] = {b"\xff\xd8\xff": "image/jpeg", b"\x89PNG": "image/png"}
"""How payloads begin that every browser can show."""


class Delay(NamedTuple):
    """What is known of the way from a robot: how far its wall clock is ahead [s], and what a sample takes at least."""

    ahead: float | None = None
    fixed: float = 0.0
    per_byte: float = 0.0


def message(head: Mapping[str, Any], body: bytes = b"") -> bytes:
    """Return what the page reads: two lengths as 32 bits, a head in JSON and a body of bytes."""
    told = json.dumps(_finite(head), allow_nan=False).encode()
    return struct.pack(">II", len(told), len(body)) + told + body


def _finite(told: Any) -> Any:
    """Return JSON data without numbers that no browser reads: these are not known, then."""
    if isinstance(told, float):
        return told if math.isfinite(told) else None
    if isinstance(told, Mapping):
        return {name: _finite(each) for name, each in told.items()}
    return [_finite(each) for each in told] if isinstance(told, list) else told


class Frames:
    """Takes samples on threads of Zenoh; those that are images go to `show` as messages, by key."""

    def __init__(self, show: Callable[[str, bytes], None]) -> None:
        self._show = show
        self._lock = threading.Lock()
        self._arrivals: dict[str, deque[float]] = {}
        self._delays: Mapping[str, Delay] = {}
        self.refused = 0
        """Images that were too large, or of too many cameras."""

    def know(self, delays: Mapping[str, Delay]) -> None:
        """This is known of the ways that samples take now, by key."""
        self._delays = delays

    def take(self, sample: zenoh.Sample) -> None:
        """Take a sample."""
        now, wall = clock.monotonic(), clock.wall()
        payload = sample.payload
        if sample.kind != zenoh.SampleKind.PUT or not 4 <= len(payload):  # noqa: SIM300 - the payload is what is measured
            return
        key = str(sample.key_expr)
        if len(payload) > TUNING.image_bytes:
            self.refused += 1
            return
        image = payload.to_bytes()
        kind = next((kind for begin, kind in KINDS.items() if image.startswith(begin)), None)
        if kind is None or not self._note(key, now):
            return
        age = self._age(key, sample.timestamp, len(image), wall)
        head = {"kind": "frame", "key": key, "type": kind, "rate": self.rates(now)[key], "age": age}
        self._show(key, message(head, image))

    def rates(self, now: float) -> dict[str, float]:
        """Return how many frames came in a second lately, by key."""
        with self._lock:
            for times in self._arrivals.values():
                while times and times[0] <= now - TUNING.rate_window:
                    times.popleft()
            return {key: len(times) / TUNING.rate_window for key, times in self._arrivals.items()}

    def _note(self, key: str, now: float) -> bool:
        with self._lock:
            if key not in self._arrivals and len(self._arrivals) >= TUNING.tiles:
                silent = next((each for each, times in self._arrivals.items() if not times), None)
                if silent is None:
                    self.refused += 1
                    return False
                del self._arrivals[silent]
            self._arrivals.setdefault(key, deque()).append(now)
            return True

    def _age(self, key: str, stamp: zenoh.Timestamp | None, size: int, wall: float) -> float:
        """Return how old a sample is that just came [s]: by its time stamp where there is one, else by its way."""
        delay = self._delays.get(key, Delay())
        if stamp is not None and delay.ahead is not None:
            return max(0.0, wall - stamp.get_time().timestamp() + delay.ahead)
        return delay.fixed + delay.per_byte * size
