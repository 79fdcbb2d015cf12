"""Our part of every shared limit as time passes: what we may use, and what our sends use of it."""

from collections.abc import Sequence

from proxy.core.protocol.bid import UNIT
from proxy.core.split.ledger import Ledger
from proxy.core.split.steady import Steady


class OwnPart:
    """What all tables entitle us to, held back by the guard time of one window, and the sends that count against it."""

    def __init__(self, now: float, windows: Sequence[float], entitled: int) -> None:
        self.window = max(windows)
        self._ledger = Ledger(windows)
        self._steady = Steady(now, entitled, self.window)

    def of(self, now: float, limit: int = 0) -> float:
        """Return what our sends within the window of a limit may use together, as a part of it; `now` may be ahead."""
        return (self._steady.least(now) + self._ledger.struck(now, limit)) / UNIT

    def free(self, now: float, limit: int = 0) -> float:
        """Return what is left of our part of a limit now."""
        return max(0.0, self._steady.least(now) - self._ledger.kept(now, limit)) / UNIT

    def within(self, now: float, part: int) -> float:
        """Return for how long we have sent nothing that does not fit so many units [s]."""
        fits = all(self._ledger.kept(now, limit) <= part for limit in range(len(self._ledger.windows)))
        return now - self._ledger.last_struck if fits else 0.0

    def grows_at(self, now: float) -> float:
        """Return when our part grows next, if nothing is heard and no turn ends [s]; ∞ where it does not."""
        return self._steady.rises_at(now)

    def changes_at(self, now: float) -> float:
        """Return when our part changes by time alone [s]."""
        return min(self._steady.rises_at(now), self._ledger.next_expiry(now))

    @property
    def busy_until(self) -> float:
        """When we sent last [s]; in the future where a message has more than one window for itself."""
        return self._ledger.last

    def spent(self, now: float, slot: int) -> bool:
        """Whether less than half of a slot of so many units is left of our part of the first limit."""
        return self._ledger.kept(now, 0) > self._steady.least(now) - slot / 2

    def sent(self, now: float, uses: Sequence[float], windows: float = 1.0) -> None:
        """We sent a message that uses such parts of the shared limits, and has so many windows for itself."""
        self._ledger.sent(now + (windows - 1.0) * self.window, [use * UNIT / windows for use in uses])

    def entitle(self, now: float, entitled: int, unused: float = 0.0) -> None:
        """We are entitled to so many units; what this rises by has been unused for so long [s]."""
        before = self._steady.least(now)
        self._steady.set(now, entitled, unused)
        self._strike(now, before)

    def give_up(self, now: float, entitled: int, slot: int, exclusive: int) -> float:
        """A slot goes to the next robot; return when the last was sent in it [s]. `exclusive`: ours without [units]."""
        before = self._steady.least(now)
        self._steady.give_up(now, entitled, slot, exclusive)
        self._strike(now, before)
        return self._ledger.last_struck

    def _strike(self, now: float, before: int) -> None:
        """Our part was so much before."""
        if (least := self._steady.least(now)) < before:
            self._ledger.strike(now, least, before - least)
