"""The clock offset between two robots from four timestamps: a digest out, its echo back.

Each digest heard bounds the offset from above, each echo of one of ours from below, both widened by what clocks can
have drifted since. The middle of the best bounds is the estimate, half their width what it may be wrong by. Wall clocks
that both robots know to be right bound it, too, unless digests prove them wrong.
"""

import math
from typing import NamedTuple

from proxy.core.transit.latency import Latency
from proxy.core.transit.tuning import TUNING


class _Bound(NamedTuple):
    """The offset was no more (or no less) than `offset` when our clock showed `at`."""

    at: float
    offset: float

    def widened(self, now: float) -> float:
        """What clocks may have drifted since [s]."""
        return TUNING.drift * max(0.0, now - self.at)


class ClockOffset:
    """Maps a peer's monotonic clock to ours. Remembers two bounds, and the last digest heard."""

    def __init__(self) -> None:
        self._most: _Bound | None = None
        self._least: _Bound | None = None
        self._last: _Bound | None = None
        self._shown: tuple[_Bound, float] | None = None
        """What wall clocks showed last, and how wrong that may be [s]."""
        self._presumed = 0.0
        """What the way here takes as long as no echo came [s]."""
        self.latency = 0.0
        """One-way time of the quickest digests [s], mean of both directions; until both were seen, what is presumed."""
        self._range = (-math.inf, math.inf)
        """The least and the most that it can have been when the last digest came [s]."""
        self.jumps = 0
        """How often a clock stood still or jumped, as one does while its robot sleeps."""

    def heard(self, sent: float, received: float) -> None:
        """A digest that the peer sent at `sent` (its clock) arrived at `received` (ours)."""
        self._last = new = _Bound(received, received - sent)
        most = self._most
        if most is None or new.offset - most.offset <= most.widened(new.at) - new.widened(most.at):
            self._most = new
        self._agree()

    def echoed(self, sent: float, received: float) -> None:
        """Our digest, sent at `sent` (our clock), arrived there at `received` (the peer's)."""
        new = _Bound(sent, sent - received)
        least = self._least
        if least is None or least.offset - new.offset <= least.widened(new.at) - new.widened(least.at):
            self._least = new
        self._agree()

    def presume(self, latency: float) -> None:
        """Until the first echo the way here is taken to be so long [s]."""
        if latency != self._presumed:
            self._presumed = latency
            self._agree()

    def shown(self, now: float, offset: float, error: float) -> None:
        """By the wall clocks of both, the offset is this at `now`, and wrong by `error` at most [s]."""
        self._shown = _Bound(now, offset), error
        self._agree()

    def unshown(self) -> None:
        """Forget what wall clocks showed: one was set, so it was wrong."""
        self._shown = None
        self._agree()

    @property
    def known(self) -> bool:
        """Whether both directions were seen."""
        return self._most is not None and self._least is not None

    @property
    def offset(self) -> float:
        """Our clock minus the peer's [s] at the last digest; without echoes as if the way here were as presumed."""
        if self._last is None:
            return 0.0
        least, most = self._range
        return most - self._presumed if math.isinf(least) else (most + least) / 2.0

    def uncertainty(self, now: float) -> float:
        """What `offset` is wrong by at most at `now` [s], if clocks drift no faster than they may; else infinite."""
        if self._last is None or self._least is None:
            return math.inf
        least, most = self._range
        return (most - least) / 2.0 + TUNING.resolution + TUNING.drift * abs(now - self._last.at)

    @property
    def line(self) -> Latency | None:
        """What digests take there and back; None while nobody can say."""
        return Latency(self.latency) if self.known or self.latency else None

    def ours(self, theirs: float) -> float:
        """The time on our clock when the peer's shows `theirs`."""
        return theirs + self.offset

    def _agree(self) -> None:
        """Where the bounds contradict each other a clock has jumped: only the last digest still tells the offset."""
        least, most = self._by_digests()
        if most - least < -TUNING.resolution:
            self.jumps += 1
            self._most, self._shown = self._last, None
            least, most = self._by_digests()
            if most - least < -TUNING.resolution:
                least, self._least = -math.inf, None
        self._range = self._narrowed(least, most)
        self.latency = self._presumed
        if self._most is not None and self._least is not None:
            self.latency = max(0.0, (self._most.offset - self._least.offset) / 2.0)

    def _by_digests(self) -> tuple[float, float]:
        """The least and the most that the offset can have been at the last digest, by digests and echoes alone [s]."""
        if self._last is None:
            return -math.inf, math.inf
        now = self._last.at
        least = -math.inf if self._least is None else self._least.offset - self._least.widened(now)
        most = math.inf if self._most is None else self._most.offset + self._most.widened(now)
        return least, most

    def _narrowed(self, least: float, most: float) -> tuple[float, float]:
        """These bounds, narrowed by what wall clocks showed unless that cannot be right [s]."""
        if self._shown is None or self._last is None:
            return least, most
        bound, error = self._shown
        error += bound.widened(self._last.at) + TUNING.resolution
        if bound.offset - error > most or bound.offset + error < least:
            return least, most
        return max(least, bound.offset - error), min(most, bound.offset + error)
