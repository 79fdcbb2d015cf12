"""Our part of what robots share: the protocol of `proxy.core.split`, for one robot."""

import math
from collections.abc import Collection, Sequence

from proxy.core.protocol.bid import UNIT, Bid, alike, alike_but_for_slots, few_parts
from proxy.core.protocol.split_report import SplitReport
from proxy.core.split.agreement import Agreement
from proxy.core.split.allocation import worth_of_equal
from proxy.core.split.exchange import Exchange
from proxy.core.split.own_part import OwnPart
from proxy.core.split.tuning import TUNING
from proxy.core.split.turns import Turn


def worthwhile(agreement: Agreement, bid: Bid, usual: int, takes: float) -> bool:
    """Whether our bid should be this one from now on, as an agreement on it, which `takes` so long [s], is worth it.

    A `usual` large message of ours takes so much [units].
    """
    same = alike(agreement.bid[1], bid) or indifferent(agreement, bid, takes)
    return not same or starves(agreement, bid, usual)


def outdoes_equal(agreement: Agreement) -> bool:
    """Whether the parts that all agreed on are worth much more to all together than equal ones."""
    table = agreement.log.agreed
    bids = {tag: entry[1] for tag, entry in table.entries.items() if entry is not None}
    return agreement.formed and table.allocation.worth(bids) > TUNING.unequal_gain * worth_of_equal(bids)


def indifferent(agreement: Agreement, bid: Bid, takes: float = 0.0) -> bool:
    """Whether little would be gained if all agreed on this bid: about what each has, or slots alone change hands.

    Or less than slots are worth that rest while all agree, which `takes` so long [s].
    """
    if (bids := _bids_with(agreement, bid)) is None:
        return False
    newest = agreement.log.newest
    had, allocation = newest.allocation, newest.allocated(bids)
    if allocation.resembles(had):
        return True
    before, after = had.worth(bids, divisible=True), allocation.worth(bids, divisible=True)
    if agreement.bid[1] and max(0.0, after - before) < takes / TUNING.gains_for * before:
        return True
    slots = alike_but_for_slots(agreement.bid[1], bid) and all(map(few_parts, bids.values()))
    if not slots or allocation.largest(agreement.own) > TUNING.message_growth * had.largest(agreement.own):
        return False
    return allocation.worth(bids) < (1.0 + TUNING.slot_gain) * had.worth(bids)


def starves(agreement: Agreement, bid: Bid, usual: int) -> bool:
    """Whether a `usual` message does not fit what we have, though it would with this bid.

    One of four robots was silent for 12 s, and twelve use 0.49 of a limit without it, not 0.66. What we ask for is
    larger than most messages, and is a little more now and then: of eight robots three asked anew each time, and all of
    them had next to nothing until they agreed.
    """
    newest = agreement.log.newest
    if newest.allocation.carries(agreement.own, usual):
        return False
    bids = _bids_with(agreement, bid)
    return bids is not None and newest.allocated(bids).carries(agreement.own, usual)


def _bids_with(agreement: Agreement, bid: Bid) -> dict[str, Bid] | None:
    """Return everybody's bid and this one of ours, if we have all."""
    newest = agreement.log.newest
    bids = {tag: entry[1] for tag, entry in newest.entries.items() if entry is not None} | {agreement.own: bid}
    return bids if newest.complete and bids.keys() == agreement.members else None


class Split:
    """One robot's part of every shared limit, by what it has heard so far.

    `windows` are those of the limits [s], `floor` is the part for newcomers. At `settled_at` [s] all have seen us.
    `kind` stands for what all must share (limits, specs); `version` is greater than any announced under our tag.
    `twice`: news is announced two times. Digests of a peer come in the order in which it sent them.
    """

    def __init__(
        self,
        own: str,
        now: float,
        windows: Sequence[float],
        *,
        floor: float,
        settled_at: float,
        kind: bytes = b"",
        version: int = 0,
        twice: bool = False,
    ) -> None:
        units = round(floor * UNIT)
        self.agreement = Agreement(own, now, floor=units, settled_at=settled_at, kind=kind, version=version)
        self.exchange = Exchange(now, self.agreement, max(windows), twice=twice)
        self.own_part = OwnPart(now, windows, self.agreement.entitled)
        self._window, self._settled_at = max(windows), settled_at
        self._started, self._bid_at = now, -math.inf
        self._passes_at = -math.inf
        """When it could be told that a slot is passed on, as we saw last [s]."""

    def due_at(self, now: float) -> float:
        """Return when our part changes by time alone, a turn ends, or we request what we miss [s]."""
        settles = self._settled_at if self.agreement.newcomer and now < self._settled_at else math.inf
        requests = min(self.exchange.requests_at, self.exchange.repeats_at)
        turns = [self._turn_ends(turn) for turn in self._held]
        return min([self.own_part.changes_at(now), settles, requests if requests > now else math.inf, *turns])

    def set_quiet(self, now: float, *, quiet: bool) -> None:
        """The team is too large to agree, or is not: we ask for nothing if any of our messages fits an equal part."""
        if self.agreement.set_quiet(now, quiet=quiet):
            self._bid_at = -math.inf  # once all agree again each asks first: they agreed on no bids else
            self.exchange.restart()
            self._entitle(now)

    def set_members(self, now: float, tags: Collection[str]) -> None:
        """These robots take part, as far as we see."""
        self.agreement.set_members(now, tags)
        self._settle(now)

    def bid(self, now: float, bid: Bid, *, usual: int = 0, takes: float = 0.0) -> bool:
        """Ask for this from now on, if it differs enough and it is time; return whether we do.

        A `usual` large message takes so much [units], to agree `takes` so long [s].
        """
        agreement = self.agreement
        if agreement.silent and any(not segment.quarters or segment.amount <= agreement.equal for segment in bid):
            return False
        if not self._may_bid(now) or not worthwhile(agreement, bid, usual, takes):
            return False
        self._bid_at = now
        agreement.ask(now, bid)
        self._settle(now)
        return True

    def announcement(self, now: float) -> SplitReport:
        """Return what our next digest announces."""
        return self.exchange.announcement(now)

    def announced(self, now: float, announcement: SplitReport) -> None:
        """This goes out in a digest."""
        self.exchange.announced(now, announcement)
        self.agreement.log.announced(announcement.table)
        self._entitle(now)

    def heard(self, now: float, peer: str, announcement: SplitReport, sent: float = -math.inf) -> None:
        """An announcement of another robot came, newer than all before, which was sent at `sent` [s]."""
        agreement, unconfirmed = self.agreement, self.agreement.unconfirmed
        agreement.heard(now, peer, announcement)
        for table in agreement.log:
            numbers = announcement.turns if table.name == announcement.agreed else ()
            for turn, number in zip(table.turns, numbers, strict=False):
                if turn.heard(now, peer, number, announcement.unused):
                    self._entitle(now, min(now - turn.used, now - agreement.log.agreed_at))
        self._settle(now)
        self.exchange.heard(now, announcement, sent, unconfirmed)

    def sent(self, now: float, uses: Sequence[float], windows: float = 1.0) -> bool:
        """We sent a message that uses such parts of the limits, over so many windows; whether we passed a slot on."""
        self.own_part.sent(now, uses, windows)
        changes = self.agreement.newcomer or self.agreement.turns
        return bool(changes) and self.advance(now, self.exchange.delay, self._passes_at)

    def advance(self, now: float, delay: float, passes_at: float = -math.inf) -> bool:
        """Time passed; news take so long to others [s]. Return whether we passed a slot on.

        Not before that could be told [s]: else twelve robots used 14 to 24 % of a limit, and use 60 to 70 now.
        """
        self.exchange.note_delay(delay)
        self._passes_at = passes_at
        if self.agreement.newcomer and now >= self._settled_at:
            self._settle(now)
        over = [turn for turn in self._held if self._is_over(now, turn)]
        for turn in over:
            turn.pass_on()
            entitled, exclusive = self.agreement.entitled, self.agreement.exclusive
            turn.note_use(self.own_part.give_up(now, entitled, turn.slot.size, exclusive))
        lost = any(self._is_lost(now, turn) for turn in self.agreement.turns)
        self.exchange.note_turns(passed_on=bool(over) or lost)
        return bool(over)

    @property
    def _held(self) -> list[Turn]:
        """The slots whose turn is ours."""
        return [turn for turn in self.agreement.turns if turn.holder == self.agreement.own]

    def _may_bid(self, now: float) -> bool:
        """Whether our bid may change: at first, then once all have agreed on the last table, and some time later."""
        agreement, interval = self.agreement, min(TUNING.bid_interval, (now - self._started) / 2)
        rested = agreement.log.agreed_at + TUNING.agreement_rest * agreement.log.took
        first = self._bid_at == -math.inf
        return first or (not agreement.pending and now >= max(self._bid_at + interval, rested))

    def _settle(self, now: float) -> None:
        self.agreement.settle(now)
        self._entitle(now)

    def _entitle(self, now: float, unused: float = 0.0) -> None:
        """What we are entitled to may have changed; what it rises by has been unused for so long [s]."""
        self.own_part.entitle(now, self.agreement.entitled, unused)

    def _turn_ends(self, turn: Turn) -> float:
        """A turn lasts as long as a message that has several windows for itself."""
        return max(turn.ends(self._window, self.exchange.delay), self.own_part.busy_until, self._passes_at)

    def _is_over(self, now: float, turn: Turn) -> bool:
        """Whether we pass a slot on: at the end of our turn, or once its last window has been used."""
        ends = self._turn_ends(turn)
        spent = self.own_part.spent(now, turn.slot.size) and max(self.own_part.busy_until, self._passes_at) <= now
        return now >= ends or (spent and now >= ends - self._window)

    def _is_lost(self, now: float, turn: Turn) -> bool:
        """Whether we passed a slot on, and nobody announces that its next turn is over though it should be."""
        ends = max(turn.ends(self._window, self.exchange.delay), self.exchange.last_at)
        return turn.giver == self.agreement.own and now >= ends + 2.0 * self.exchange.patience
