"""What one robot announces of the split, and what it requests again of what it missed.

A bid is announced until all have it, the name of a table once it holds the bids of all, each twice where digests are
broadcast (ten robots at 1 s: 82 % of a central decider instead of 78). Who misses something requests it for all.
"""

import math
import zlib

from proxy.core.protocol.split_report import SplitReport
from proxy.core.protocol.tuning import TUNING as BOUNDS
from proxy.core.split.agreement import Agreement
from proxy.core.split.tuning import TUNING


class Exchange:
    """One robot's announcements and requests."""

    def __init__(self, now: float, agreement: Agreement, window: float, *, twice: bool) -> None:
        self._agreement, self._window, self._twice = agreement, window, twice
        self._phase = zlib.crc32(agreement.own.encode()) / 2**32
        """Who misses the same does not request it at the same moment: one does for all."""
        self.delay = 0.0
        """How long news take to others [s]."""
        self._last: SplitReport | None = None
        """What we announced last; None where the team has just begun to split."""
        self.last_at = now
        """When that was [s]."""
        self._heard_at, self._requests = now, 0
        """When we last heard, told or requested news [s], not when we answered, and how often we did since."""
        self.repeats_at = math.inf
        """When we announce again what was news [s]."""
        self._again = False
        """Whether we announce again, because another robot requests it, or a slot was passed on and not taken."""
        self.passes_on = False
        """Whether that is for a slot: one robot waits for us alone."""

    @property
    def patience(self) -> float:
        """How long we wait for what we miss [s]."""
        return TUNING.request_delay + TUNING.request_news * self.delay

    @property
    def requests_at(self) -> float:
        """When we request what we miss [s]; never where we miss nothing."""
        missed = len(self._agreement.unconfirmed)
        if self._last is None or self._agreement.quiet or not missed:
            return math.inf
        # What most have not said is not lost but late: how long news take is not known at first.
        late = 2.0 if 2 * missed > len(self._agreement.others) else 1.0
        return self._heard_at + late * self.patience * (1.0 + self._phase) * 2.0**self._requests

    def announcement(self, now: float) -> SplitReport:
        """Return what our next digest announces."""
        agreement, (version, bid) = self._agreement, self._agreement.bid
        passed = [now - turn.used for turn in agreement.turns if turn.giver == agreement.own and not agreement.pending]
        return SplitReport(
            version,
            None if agreement.known_by >= agreement.others else bid,
            agreement.log.newest.name,
            0 if agreement.newcomer else agreement.log.agreed.name,
            tuple(turn.number for turn in agreement.turns),
            min(self._window, *passed) if passed else 0.0,
            self._mask(agreement.unconfirmed) if now >= self.requests_at else 0,
        )

    def has_news(self, now: float) -> bool:
        """Whether others wait to hear from us: a bid, that we have everybody's, that a slot is passed on."""
        if self._agreement.silent:
            return False
        return self._again or now >= min(self.requests_at, self.repeats_at) or self.has_statement

    @property
    def has_statement(self) -> bool:
        """Whether others wait to hear of a bid, or that we have everybody's."""
        agreement, last, newest = self._agreement, self._last, self._agreement.log.newest
        if last is None:
            return len(agreement.members) > 1
        return last.version != agreement.bid[0] or (newest.complete and last.table != newest.name)

    @property
    def asks(self) -> bool:
        """Whether our bid is another one than what we announced last."""
        return self._last is not None and self._last.version != self._agreement.bid[0]

    def begin(self) -> None:
        """From now on digests announce parts; what was announced while the team split before was long ago."""
        self._last = None

    def restart(self) -> None:
        """All give up what they agreed on."""
        self._last, self._again = None, False

    def announced(self, now: float, announcement: SplitReport) -> None:
        """This goes out in a digest."""
        news = self._last is None or (self._last.version, self._last.table) != (
            announcement.version,
            announcement.table,
        )
        self.repeats_at = now + TUNING.repeat_after if news and self._twice else math.inf
        if announcement.missing:
            self._heard_at, self._requests = now, min(self._requests + 1, TUNING.request_doublings)
        elif news:
            self._heard_at = now
        self._last, self.last_at, self._again, self.passes_on = announcement, now, False, False

    def heard(self, now: float, announcement: SplitReport, sent: float, unconfirmed: set[str]) -> None:
        """An announcement of another robot came, sent at `sent` [s]; before it these were `unconfirmed`."""
        requested = bool(announcement.missing & self._mask({self._agreement.own}))
        self._again |= requested and sent > self.last_at + self.delay
        if self._agreement.unconfirmed != unconfirmed:
            self._heard_at, self._requests = now, 0
        ours = self._mask(self._agreement.unconfirmed)
        if ours and announcement.missing & ours == ours:
            self._heard_at = now

    def note_delay(self, delay: float) -> None:
        """News take so long to others now [s]."""
        self.delay = delay

    def note_turns(self, *, passed_on: bool) -> None:
        """Whether the next robot of a slot has to hear that we passed it on."""
        self.passes_on |= passed_on
        self._again |= self.passes_on

    def _mask(self, tags: set[str]) -> int:
        """Return a bit for each of some robots, as far as there are bits for them."""
        members = sorted(self._agreement.members)
        return sum(1 << place for place, tag in enumerate(members[: BOUNDS.askable]) if tag in tags)
