"""All that was seen: every stream, and how much came in any window of time."""

import math
from collections import Counter
from collections.abc import Callable, Iterable

import zenoh

from utility_specs.learning.observed import Observed
from utility_specs.learning.stream import Stream, Timing

WINDOW = 0.5
"""Time over which rates are told: that of constraints unless they say otherwise [s]."""
MOST_STREAMS = 2048
MOST_WINDOWS = 1_000_000
LONGEST_KEY = 512
"""Characters of the longest key that is looked at."""


class Traffic:
    """What was seen of samples, in the order in which they came."""

    def __init__(self, timing: Callable[[], Timing]) -> None:
        self._timing = timing
        self._streams: dict[tuple[str, str | None], Stream] = {}
        self._windows: Counter[int] = Counter()
        self._first = math.inf
        self._last = -math.inf
        self.odd = 0
        """Samples whose keys nobody can write."""
        self.untold = 0
        """Samples of streams that came when there were `MOST_STREAMS`."""

    @classmethod
    def of(cls, samples: Iterable[Observed], timing: Callable[[], Timing]) -> "Traffic":
        """Look at samples; `timing` makes what finds out how one stream generates."""
        traffic = cls(timing)
        for sample in samples:
            traffic.take(sample)
        return traffic

    @property
    def streams(self) -> list[Stream]:
        """All streams, by key."""
        return sorted(self._streams.values(), key=lambda stream: stream.key)

    @property
    def count(self) -> int:
        """Samples that were looked at."""
        return sum(stream.count for stream in self._streams.values())

    @property
    def bytes(self) -> int:
        """Bytes of all payloads."""
        return sum(stream.bytes for stream in self._streams.values())

    @property
    def duration(self) -> float:
        """From the first sample to the last [s]."""
        return max(0.0, self._last - self._first)

    def take(self, sample: Observed) -> None:
        """Take in a sample."""
        stream = self._stream(sample)
        if stream is None:
            return
        stream.take(sample)
        self._first, self._last = min(self._first, sample.time), max(self._last, sample.time)
        if len(self._windows) < MOST_WINDOWS:
            self._windows[math.floor(sample.time / WINDOW)] += sample.size

    def rate(self, part: float) -> float:
        """Return what so large a part of all windows, from 0 to 1, did not exceed [B/s]."""
        whole = max(self._windows) - min(self._windows) + 1
        busy = sorted(self._windows.values())
        place = math.ceil(part * whole) - 1 - (whole - len(busy))
        return busy[place] / WINDOW if place >= 0 else 0.0

    def _stream(self, sample: Observed) -> Stream | None:
        known = self._streams.get((sample.key, sample.origin))
        if known is not None:
            return known
        if not _writable(sample.key):
            self.odd += 1
        elif len(self._streams) == MOST_STREAMS:
            self.untold += 1
        else:
            known = self._streams[sample.key, sample.origin] = Stream(sample.key, self._timing())
        return known


def _writable(key: str) -> bool:
    """Whether a spec can name the key: braces would have a meaning of their own there."""
    if len(key) > LONGEST_KEY or not key.isprintable() or any(sign in key for sign in "{}*$"):
        return False
    try:
        zenoh.KeyExpr(key)
    except zenoh.ZError:
        return False
    return True
