"""What a robot and the others agree on: their bids, the tables of these, and what all tables that count give it."""

from collections.abc import Collection

from proxy.core.protocol.bid import UNIT, Bid, alike_but_for_slots, few_parts
from proxy.core.split.allocation import Allocation, allocate
from proxy.core.split.standing import Entry, Standing
from proxy.core.split.turns import Turn

NEWCOMERS = 4
"""So many robots may come at once: each has this part of the floor until all know it."""
MOST_STANDING = 8
"""Tables that are kept one by one; of those between the oldest and the newest, the least part is kept."""
GAIN = 0.1
"""Slots change hands where all together gain so much: until all agree on that each has the least that any table gives
it, for some seconds, in a team of ten for 20. Where slots that are worth no more were reason enough four cameras
reached 91 % of a central decider, and reach 93 now (300 ms), ten robots with equal messages 75 to 91, and 79 to 94."""
LARGER = 1.1
"""They do, too, where we could send messages that are so many times as large."""
MOST_KNOWN = 256
"""Bids that are kept of robots, those that are gone included."""


class Agreement:
    """The tables that count for one robot: from the last one agreed on to the newest one.

    `floor` is in units. `version` is the first one of our bids: greater than any that was told under our tag before.
    """

    def __init__(self, own: str, now: float, *, floor: int, settled_at: float, kind: bytes, version: int) -> None:
        self.own, self._floor, self._kind, self._settled_at = own, floor, kind, settled_at
        self.members = {own}
        self._bids: dict[str, Entry] = {own: (version, ())}
        self._last: dict[str, tuple[int, int]] = {}
        self._known_by: set[str] = set()
        self.newcomer = True
        """Whether we have agreed on nothing yet."""
        self._seen, self._kept = False, floor // NEWCOMERS
        """Whether all who are there have seen us, and what we may use until then [units]."""
        self.formed = False
        """Whether we have ever agreed on a table with everybody's bid."""
        self.since, self.took, self._formed = now, 0.0, now
        self._folded = UNIT
        self.standings = [self._standing({own: self._bids[own]})]

    @property
    def bid(self) -> Entry:
        """Our bid and its version."""
        return self._bids[self.own]

    @property
    def known(self) -> bool:
        """Whether all others know our bid."""
        return self._known_by >= self.members - {self.own}

    @property
    def pending(self) -> bool:
        """Whether there are tables after the one agreed on."""
        return self.newcomer or len(self.standings) > 1

    @property
    def settled(self) -> bool:
        """Whether we have agreed on our newest table, and so has everybody as far as known."""
        newest = self.standings[-1].name
        others = self.members - {self.own}
        return not self.pending and all(self._last.get(tag, (0, 0))[1] == newest for tag in others)

    @property
    def rivals(self) -> bool:
        """Whether another robot asks for anything, as far as we know."""
        return any(self._bids.get(tag, (0, ()))[1] for tag in self.members - {self.own})

    @property
    def missing(self) -> set[str]:
        """Whose bid we do not know; where we know all, who did not tell yet that it has our newest table."""
        newest = self.standings[-1]
        unknown = {tag for tag, entry in newest.table.items() if entry is None}
        return unknown or (newest.bidders - newest.told if self.pending else set())

    @property
    def complete(self) -> bool:
        """Whether our newest table holds the bids of all."""
        return self.standings[-1].complete

    @property
    def entitled(self) -> int:
        """What all tables that count give us now [units]."""
        if self.newcomer and not self._seen:
            return self._kept
        return min([self._folded, self._first, *(standing.total for standing in self._counting)])

    @property
    def own_part(self) -> int:
        """What they give us without slots [units]."""
        return min([self._folded, self._first, *(standing.part for standing in self._counting)])

    @property
    def equal(self) -> int:
        """An equal part: the others leave it to us until they know what we ask for [units]."""
        return (UNIT - self._floor) // len(self.members)

    @property
    def _first(self) -> int:
        """What a newcomer has at most that all have seen [units]."""
        return self.equal if self.newcomer else UNIT

    @property
    def _counting(self) -> list[Standing]:
        """The table that we agreed on, and those that others may have: not before we told that we have them."""
        return [standing for standing in self.standings if standing.counts]

    @property
    def turns(self) -> list[Turn]:
        """The slots of the table that we agreed on last."""
        return [] if self.newcomer else self.standings[0].turns

    def indifferent(self, bid: Bid) -> bool:
        """Whether we have everybody's bid, and little would be gained if all agreed on this one of ours.

        Either each would have about what it has, or slots alone would change hands, and all together gain little.
        """
        if (bids := self._bids_with(bid)) is None:
            return False
        had, allocation = self.standings[-1].allocation, self._allocated(bids)
        if allocation.resembles(had):
            return True
        slots = alike_but_for_slots(self.bid[1], bid) and all(map(few_parts, bids.values()))
        if not slots or allocation.largest(self.own) > LARGER * had.largest(self.own):
            return False
        return allocation.worth(bids) < (1.0 + GAIN) * had.worth(bids)

    def starves(self, bid: Bid) -> bool:
        """Whether no message fits what we have, though one would with this bid: what we asked for was a bit too small.

        One of four robots with cameras was silent so for 12 s, with its part unused.
        """
        if self.standings[-1].allocation.carries(self.own, bid):
            return False
        bids = self._bids_with(bid)
        return bids is not None and self._allocated(bids).carries(self.own, bid)

    def _bids_with(self, bid: Bid) -> dict[str, Bid] | None:
        """Return everybody's bid and this one of ours, if we have all."""
        newest = self.standings[-1]
        bids = {tag: entry[1] for tag, entry in newest.table.items() if entry is not None} | {self.own: bid}
        return bids if newest.complete and bids.keys() == self.members else None

    def _allocated(self, bids: dict[str, Bid]) -> Allocation:
        """Return what each would have with these bids."""
        return allocate(bids, len(bids), self._floor, self.standings[-1].name)

    def ask(self, now: float, bid: Bid) -> None:
        """This is our bid from now on."""
        self._bids[self.own] = self.bid[0] + 1, bid
        self._known_by = set()
        self._form(now)

    def restart(self, now: float, settled_at: float) -> None:
        """All give up what they agreed on for equal parts, and have by then [s]: until then we use no more."""
        self._kept = min(self.entitled, self.equal)
        self.newcomer, self.formed, self._seen, self._settled_at = True, False, False, settled_at
        self._bids = {self.own: (self.bid[0] + 1, ())}
        self._known_by, self._last, self._folded, self.since, self._formed = set(), {}, UNIT, now, now
        self.standings = [self._standing(dict(self._bids))]

    def set_members(self, now: float, tags: Collection[str]) -> None:
        """These robots take part, as far as we see."""
        before, self.members = self.members, {*tags, self.own}
        if before == self.members:
            return
        self._known_by &= self.members
        self._last = {tag: names for tag, names in self._last.items() if tag in self.members}
        if self.members - before:
            self._reserve()
        if before - self.members:
            self.ask(now, self.bid[1])
        self._form(now)

    def heard(self, now: float, peer: str, version: int, bid: Bid | None, names: tuple[int, int]) -> None:
        """A robot told its bid, if that is news, and the names of its newest table and of that it agreed on."""
        if bid is not None and version > self._bids.get(peer, (-1, ()))[0]:
            self._bids.pop(peer, None)
            self._bids[peer] = version, bid
            self._forget_some()
            self._form(now)
        self._last[peer] = names

    def told(self, name: int) -> None:
        """A digest of ours tells that we have the table of this name: from now on others may agree on it."""
        for standing in self.standings:
            standing.counts |= standing.name == name

    def settle(self, now: float) -> None:
        """Look what has been agreed on."""
        self._seen |= now >= self._settled_at and len(self.members) > 1
        for standing in self.standings:
            standing.told |= {tag for tag, names in self._last.items() if standing.name in names}
            if standing.table[self.own] == self.bid:
                self._known_by |= standing.told & self.members
        agreed = [i for i, standing in enumerate(self.standings) if self._counts(now, standing)]
        if agreed and (agreed[-1] > 0 or self.newcomer):
            self._agree(now, agreed[-1])
        while len(self.standings) > MOST_STANDING:
            least = self.standings.pop(1)
            self._folded = min(self._folded, least.part) if least.counts else self._folded

    def _counts(self, now: float, standing: Standing) -> bool:
        """Whether a table is agreed on: by a newcomer, with all bids, or a part for everybody once all see it."""
        settled = now >= self._settled_at and self.members <= standing.table.keys()
        first = settled or (standing.complete and bool(standing.bidders))
        return standing.agreed and (first or not self.newcomer)

    def _agree(self, now: float, index: int) -> None:
        """Leave out all tables before this one."""
        self.standings = self.standings[index:]
        self.standings[0].counts = True
        self.newcomer, self._folded, self.since, self.took = False, UNIT, now, now - self._formed
        self.formed |= self.standings[0].complete and len(self.members) > 1
        for turn in self.turns:
            turn.used = turn.used if turn.number else now

    def _standing(self, table: dict[str, Entry | None]) -> Standing:
        members = len(self.members | {tag for tag, entry in table.items() if entry is None})
        return Standing(self.own, table, members=members, floor=self._floor, kind=self._kind)

    def _form(self, now: float) -> None:
        """Form our newest table."""
        newest = self._standing({tag: self._bids.get(tag) for tag in self.members})
        if newest.name != self.standings[-1].name:
            self.standings.append(newest)
            self._formed = now

    def _reserve(self) -> None:
        """Leave equal parts to those who came, whatever they bid, until all agree on a table with them."""
        agreed = self.standings[0].table
        if unknown := self.members - agreed.keys():
            self.standings.append(self._standing(agreed | dict.fromkeys(unknown)))
            self.standings[-1].counts = True

    def _forget_some(self) -> None:
        gone = [tag for tag in self._bids if tag not in self.members]
        for tag in gone[: max(0, len(self._bids) - MOST_KNOWN)]:
            del self._bids[tag]
