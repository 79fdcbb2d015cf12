"""The clock offset between two robots from four timestamps: a digest out, its echo back.

The one-way times there and back each hold the offset with opposite sign; the least of each over the recent past is
the pair that waited least, so half their difference is the offset and half their sum the latency.
"""

from collections import deque

MEMORY = 32
"""One-way times looked back on."""


class ClockOffset:
    """Maps a peer's monotonic clock to ours."""

    def __init__(self) -> None:
        self._there: deque[float] = deque(maxlen=MEMORY)
        self._back: deque[float] = deque(maxlen=MEMORY)

    def heard(self, sent: float, received: float) -> None:
        """A digest that the peer sent at `sent` (its clock) arrived at `received` (ours)."""
        self._there.append(received - sent)

    def echoed(self, sent: float, received: float) -> None:
        """Our digest, sent at `sent` (our clock), arrived there at `received` (the peer's)."""
        self._back.append(received - sent)

    @property
    def known(self) -> bool:
        """Whether both directions were seen."""
        return bool(self._there and self._back)

    @property
    def offset(self) -> float:
        """Our clock minus the peer's [s]; without echoes, as if the way here took no time."""
        if not self._there:
            return 0.0
        here = min(self._there)
        return (here - min(self._back)) / 2.0 if self._back else here

    @property
    def latency(self) -> float:
        """One-way time of a digest [s], mean of both directions; 0.0 until both were seen."""
        return max(0.0, (min(self._there) + min(self._back)) / 2.0) if self.known else 0.0

    def ours(self, theirs: float) -> float:
        """The time on our clock when the peer's shows `theirs`."""
        return theirs + self.offset
