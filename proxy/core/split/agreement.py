"""What a robot and the others agree on: who takes part, what each asks for, and which tables of that count."""

from collections.abc import Collection, Mapping

from proxy.core.protocol.bid import UNIT, Bid
from proxy.core.protocol.split_report import SplitReport
from proxy.core.split.table import Entry, Table, TableLog
from proxy.core.split.tuning import TUNING
from proxy.core.split.turns import Turn


class _Returns:
    """Who is back so soon that it may have noticed nothing, and goes on with what it had."""

    def __init__(self, settle_time: float) -> None:
        self._settle_time = settle_time
        self._lost: dict[str, float] = {}
        """By tag, when each that is gone was lost sight of [s]."""
        self._unaware: set[str] = set()

    def note(self, now: float, before: set[str], members: set[str]) -> None:
        """The members have been others until now; one is seen gone, or back, up to the time to settle later."""
        since = now - 2.0 * self._settle_time
        self._lost = {tag: at for tag, at in self._lost.items() if at > since}
        self._unaware = (self._unaware & members) | (self._lost.keys() & (members - before))
        self._lost |= dict.fromkeys(before - members, now)

    def awaits(self, agreed: Table, *, quiet: bool) -> bool:
        """Whether one of them has not agreed yet on what we agreed on; equal parts need no agreement."""
        return not quiet and bool(self._unaware - agreed.bidders)


class Agreement:
    """One robot's side of the agreement; `floor` is in units, `version` greater than all announced under our tag."""

    def __init__(self, own: str, now: float, *, floor: int, settled_at: float, kind: bytes, version: int) -> None:
        self.own, self._floor, self._kind = own, floor, kind
        self._settled_at, self._settle_time = settled_at, settled_at - now
        self.members, self.others = {own}, set[str]()
        """Who takes part, with us and without."""
        self._bids: dict[str, Entry] = {own: (version, ())}
        self._held: dict[str, dict[int, bool]] = {}
        """By tag, the names of the last tables that another robot had, and whether it agreed on them."""
        self._returns = _Returns(self._settle_time)
        self.known_by: set[str] = set()
        """Who has our bid."""
        self.newcomer = True
        """Whether we have agreed on nothing yet."""
        self._seen, self._kept = False, floor // TUNING.newcomers
        """Whether all who are there have seen us, and what we may use until then [units]."""
        self.formed = False
        """Whether we have ever agreed on a table with everybody's bid."""
        self.quiet = False
        """Whether the team is too large to agree."""
        self.others_agreed = False
        """Whether another robot has ever agreed on a table, as far as we heard."""
        self.log = TableLog(now, self._table(self._bids))

    @property
    def bid(self) -> Entry:
        """Our bid and its version."""
        return self._bids[self.own]

    @property
    def pending(self) -> bool:
        """Whether there are tables after the one agreed on."""
        return self.newcomer or self.log.pending

    @property
    def silent(self) -> bool:
        """Whether we ask for nothing and announce nothing: the others leave us an equal part."""
        return self.quiet and not self.bid[1]

    @property
    def settled(self) -> bool:
        """Whether we have agreed on our newest table, and so has everybody as far as known, so that nobody waits."""
        newest = self.log.newest.name
        return self.silent or (not self.pending and all(self._held.get(tag, {}).get(newest) for tag in self.others))

    @property
    def rivals(self) -> bool:
        """Whether another robot asks for anything, as far as we know."""
        return any(self._bids.get(tag, (0, ()))[1] for tag in self.others)

    @property
    def unconfirmed(self) -> set[str]:
        """Whose bid we do not know; where we know all, who did not confirm yet that it has our newest table."""
        newest = self.log.newest
        unknown = {tag for tag, entry in newest.entries.items() if entry is None}
        return unknown or (newest.bidders - newest.confirmed_by if self.pending else set())

    @property
    def entitled(self) -> int:
        """What all tables that count give us now [units]; a newcomer has at most an equal part.

        Beside who is back and has noticed nothing we are newcomers, too: else the two held 1.35 limits.
        """
        if self._returns.awaits(self.log.agreed, quiet=self.quiet):
            return min(self._kept, self.log.total)
        if not self.newcomer:
            return self.log.total
        return min(self.equal, self.log.total) if self._seen else self._kept

    @property
    def exclusive(self) -> int:
        """What they give us without slots [units]."""
        if self._returns.awaits(self.log.agreed, quiet=self.quiet):
            return min(self._kept, self.log.part)
        return min(self.equal, self.log.part) if self.newcomer else self.log.part

    @property
    def equal(self) -> int:
        """An equal part: the others leave it to us until they know what we ask for [units]."""
        return (UNIT - self._floor) // len(self.members)

    @property
    def turns(self) -> list[Turn]:
        """The slots of the table that we agreed on last."""
        return [] if self.newcomer else self.log.agreed.turns

    def ask(self, now: float, bid: Bid) -> None:
        """This is our bid from now on."""
        self._bids[self.own] = self.bid[0] + 1, bid
        self.known_by = set()
        self._form(now)

    def set_quiet(self, now: float, *, quiet: bool) -> bool:
        """The team is too large to agree, or is not; whether all give up what they agreed on now, for equal parts."""
        begins, self.quiet = quiet and not self.quiet, quiet
        if begins:
            self._kept = min(self.entitled, self.equal)
            self.newcomer, self.formed, self._seen, self._settled_at = True, False, False, now + self._settle_time
            self._bids = {self.own: (self.bid[0] + 1, ())}
            self.known_by, self._held = set(), {}
            self.log = TableLog(now, self._table(self._bids))
        return begins

    def set_members(self, now: float, tags: Collection[str]) -> None:
        """These robots take part, as far as we see."""
        before, self.members, self.others = self.members, {*tags, self.own}, {*tags} - {self.own}
        if before == self.members:
            return
        self.known_by &= self.members
        self._held = {tag: names for tag, names in self._held.items() if tag in self.members}
        self._returns.note(now, before, self.members)
        agreed = self.log.agreed.entries
        if (self.members - before) and (unknown := self.members - agreed.keys()):
            self.log.reserve(self._table(agreed | dict.fromkeys(unknown), counts=True))
        if before - self.members:
            self.ask(now, self.bid[1])
        self._form(now)

    def heard(self, now: float, peer: str, announcement: SplitReport) -> None:
        """A robot announced its bid, if that is news, and the names of its newest table and of that it agreed on."""
        version, bid = announcement.version, announcement.bid
        if bid is not None and version > self._bids.get(peer, (-1, ()))[0]:
            self._bids.pop(peer, None)
            self._bids[peer] = version, bid
            gone = [tag for tag in self._bids if tag not in self.members]
            for tag in gone[: max(0, len(self._bids) - TUNING.bids_kept)]:
                del self._bids[tag]
            self._form(now)
        self.others_agreed |= announcement.agreed != 0
        held = self._held.setdefault(peer, {})
        for name, agreed in ((announcement.table, False), (announcement.agreed, True)):
            held[name] = held.pop(name, False) or agreed
        for name in list(held)[: -TUNING.tables_kept]:
            del held[name]

    def settle(self, now: float) -> None:
        """See what has been agreed on."""
        self._seen |= now >= self._settled_at and len(self.members) > 1
        self.log.confirm(self._held)
        having = (table.confirmed_by for table in self.log if table.entries[self.own] == self.bid)
        self.known_by |= set().union(*having) & self.members
        agreed = [index for index, table in enumerate(self.log) if table.agreed and self._may_agree(now, table)]
        if agreed and (agreed[-1] > 0 or self.newcomer):
            self.log.agree(now, agreed[-1])
            self.newcomer = False
            self.formed |= self.log.agreed.complete and len(self.members) > 1
        self.log.compact()

    def _may_agree(self, now: float, table: Table) -> bool:
        """Whether it may be agreed on: by a newcomer, with all bids, or a part for everybody once all see it."""
        settled = now >= self._settled_at and self.members <= table.entries.keys()
        return settled or (table.complete and bool(table.bidders)) or not self.newcomer

    def _table(self, entries: Mapping[str, Entry | None], *, counts: bool = False) -> Table:
        members = len(self.members | {tag for tag, entry in entries.items() if entry is None})
        return Table(self.own, entries, members=members, floor=self._floor, kind=self._kind, counts=counts)

    def _form(self, now: float) -> None:
        self.log.append(now, self._table({tag: self._bids.get(tag) for tag in self.members}))
