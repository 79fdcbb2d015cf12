"""Listening to all samples for a while, in memory or to a recording."""

import threading
from collections.abc import Callable

import zenoh

from proxy import clock
from utility_specs.learning import Observed

MOST_BYTES = 256 * 1024 * 1024
"""Bytes that are kept in memory; a recording may be longer."""


class Listener:
    """Takes samples until there are enough: `over` is set then, and `full` if that is for want of memory.

    With `add` they go there, else they are kept in `samples`. Where it fails that is over, too, and `failure` says why.
    """

    def __init__(self, most: int | None = None, add: Callable[[Observed], None] | None = None) -> None:
        self.samples: list[Observed] = []
        self.count = 0
        self.full = False
        self.failure: OSError | None = None
        self.over = threading.Event()
        self._most = most
        self._add = add or self._keep
        self._bytes = 0
        self._lock = threading.Lock()

    def take(self, sample: zenoh.Sample) -> None:
        """Take a sample, on any thread; deletes and whatever comes when it is over are nothing to learn from."""
        now = clock.monotonic()
        if sample.kind != zenoh.SampleKind.PUT:
            return
        observed = _observed(sample, now)
        with self._lock:
            if self.over.is_set():
                return
            try:
                self._add(observed)
            except OSError as error:
                self.failure = error
                self.over.set()
                return
            self.count += 1
            if self.full or self.count == self._most:
                self.over.set()

    def stop(self) -> None:
        """Take no more."""
        with self._lock:
            self.over.set()

    def _keep(self, sample: Observed) -> None:
        self.samples.append(sample)
        self._bytes += sample.size
        self.full = self._bytes >= MOST_BYTES


def _observed(sample: zenoh.Sample, now: float) -> Observed:
    attachment, stamp = sample.attachment, sample.timestamp
    return Observed(
        now,
        str(sample.key_expr),
        sample.payload.to_bytes(),
        str(sample.encoding),
        None if attachment is None else attachment.to_bytes(),
        None if stamp is None else str(stamp.get_id()),
    )
