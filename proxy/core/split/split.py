"""Our part of what robots share: the protocol of `proxy.core.split`, for one robot."""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from proxy.core.split.bid import UNIT, Bid, alike
from proxy.core.split.ledger import Ledger
from proxy.core.split.standing import Entry, Standing
from proxy.core.split.steady import Steady
from proxy.core.split.turns import Turn

NEWCOMERS = 4
"""So many robots may come at once: each has this part of the floor until all know it."""
MOST_STANDING = 8
"""Tables that are kept one by one; of those between the oldest and the newest, the least part is kept."""
MOST_KNOWN = 256
"""Bids that are kept of robots, those that are gone included."""
PATIENCE = 2.0
"""A bid changes no sooner after all agreed [s] ..."""
PACE = 4.0
"""... nor sooner than so many times what agreeing took."""


@dataclass(frozen=True, slots=True)
class Told:
    """What a robot's digest says of the split."""

    version: int
    bid: Bid | None
    """None where all who take part know it."""
    table: int
    """The name of the sender's newest table."""
    agreed: int
    """The name of the last table that it agreed on; 0: none yet."""
    turns: tuple[int, ...] = ()
    """Turn numbers of the slots of that table."""
    unused: float = 0.0
    """For how long no slot was used that the sender passed on [s]; what is rounded is rounded down."""


class Split:
    """One robot's part of every shared limit, by what it has heard so far.

    `windows` are those of the shared limits [s]. `floor` is the part of the limits that is kept for newcomers. A robot
    that sees nobody at `settled_at` [s] has everything. `kind` stands for what all must share to take part together
    (limits, specs). Digests of a peer come in the order in which it sent them; late ones are left out by the caller.
    """

    def __init__(
        self, own: str, now: float, windows: Sequence[float], *, floor: float, settled_at: float, kind: bytes = b""
    ) -> None:
        self.own, self._window, self._floor, self._kind = own, max(windows), round(floor * UNIT), kind
        self._settled_at = settled_at
        self._members = {own}
        self._bids: dict[str, Entry] = {own: (0, ())}
        self._asked = False
        self._last: dict[str, tuple[int, int]] = {}
        self._known_by: set[str] = set()
        self._newcomer, self._met = True, False
        self._formed = self._agreed_at = now
        self._round = self._news = 0.0
        self._folded = UNIT
        self._standings = [self._standing({own: self._bids[own]})]
        self._ledger = Ledger(windows)
        self._steady = Steady(now, self._entitled(), self._window)

    def part(self, now: float, limit: int = 0) -> float:
        """Return what our sends within the window of a limit may use together, as a part of it."""
        return (self._steady.least(now) + self._ledger.struck(now, limit)) / UNIT

    @property
    def agreed(self) -> bool:
        """Whether we have agreed on any table."""
        return not self._newcomer

    @property
    def waits_for_turn(self) -> bool:
        """Whether we share slots of which none is ours now."""
        turns = self._standings[0].turns
        return any(self._shares(turn) for turn in turns) and not self._standings[0].held

    @property
    def settled(self) -> bool:
        """Whether we have agreed on our newest table, and so has everybody as far as known."""
        (*before, newest) = self._standings
        others = self._members - {self.own}
        return not (before or self._newcomer) and all(self._last.get(tag, (0, 0))[1] == newest.name for tag in others)

    def due_at(self, now: float) -> float:
        """Return when our part changes by time alone, or a turn ends [s]."""
        turns = [self._turn_ends(turn) for turn in self._standings[0].held] if not self._newcomer else []
        settles = self._settled_at if self._newcomer and len(self._members) == 1 else math.inf
        return min([self._steady.rises_at(now), self._ledger.next_expiry(now), settles, *turns])

    def telling(self, now: float) -> Told:
        """Return what our next digest says."""
        version, bid = self._bids[self.own]
        agreed, newest = self._standings[0], self._standings[-1]
        ours = [now - turn.used for turn in agreed.turns if turn.giver == self.own]
        return Told(
            version,
            None if self._known_by >= self._members - {self.own} else bid,
            newest.name,
            0 if self._newcomer else agreed.name,
            () if self._newcomer else tuple(turn.number for turn in agreed.turns),
            min([self._window, *ours]),
        )

    def bid(self, now: float, bid: Bid) -> bool:
        """Ask for this from now on, if it differs enough and it is time; return whether we do."""
        version, before = self._bids[self.own]
        due = self._standings[0] is self._standings[-1] and now >= self._agreed_at + max(PATIENCE, PACE * self._round)
        if (self._asked and not due) or alike(before, bid):
            return False
        self._asked = True
        self._set_own((version + 1, bid))
        self._renew(now)
        return True

    def set_members(self, now: float, tags: Collection[str]) -> None:
        """These robots take part, as far as we see."""
        members = {*tags, self.own}
        lost, gained = self._members - members, members - self._members
        if not lost and not gained:
            return
        self._members, self._met = members, True
        if lost:
            version, bid = self._bids[self.own]
            self._set_own((version + 1, bid))
        self._known_by &= members
        self._last = {tag: told for tag, told in self._last.items() if tag in members}
        if gained and not self._newcomer:
            self._reserve_for(gained)
        self._renew(now)

    def heard(self, now: float, peer: str, told: Told) -> None:
        """A digest of another robot came, newer than all before."""
        if told.bid is not None and told.version > self._bids.get(peer, (-1, ()))[0]:
            self._bids.pop(peer, None)
            self._bids[peer] = told.version, told.bid
            self._forget_some()
        self._last[peer] = told.table, told.agreed
        for standing in self._standings:
            if standing.name == told.agreed:
                self._hear_turns(now, peer, told, standing)
        self._renew(now)

    def sent(self, now: float, uses: Sequence[float]) -> None:
        """We sent a message that uses such parts of the shared limits."""
        self._ledger.sent(now, [use * UNIT for use in uses])
        self.look(now, self._news)

    def look(self, now: float, news: float) -> bool:
        """Time passed; news take so long to others [s]. Return whether we passed a slot on."""
        self._news = news
        if self._newcomer and len(self._members) == 1 and now >= self._settled_at:
            self._renew(now)
            if not self._met:
                self._steady = Steady(now, self._entitled(), self._window)
        if self._newcomer:
            return False
        over = [turn for turn in self._standings[0].held if self._is_over(now, turn)]
        for turn in over:
            self._pass_on(now, turn)
        return bool(over)

    def _standing(self, table: dict[str, Entry | None]) -> Standing:
        members = len(self._members | {tag for tag, entry in table.items() if entry is None})
        return Standing(self.own, table, members=members, floor=self._floor, kind=self._kind)

    def _set_own(self, entry: Entry) -> None:
        self._bids[self.own] = entry
        self._known_by = set()

    def _forget_some(self) -> None:
        gone = [tag for tag in self._bids if tag not in self._members]
        for tag in gone[: max(0, len(self._bids) - MOST_KNOWN)]:
            del self._bids[tag]

    def _reserve_for(self, gained: set[str]) -> None:
        """Leave equal parts to those who came, whatever they bid, until all agree on a table with them."""
        agreed = self._standings[0].table
        table = agreed | {tag: None for tag in gained if tag not in agreed}
        self._standings.append(self._standing(table))

    def _renew(self, now: float) -> None:
        """Form our newest table, and look what has been agreed on."""
        newest = self._standing({tag: self._bids.get(tag) for tag in self._members})
        if newest.name != self._standings[-1].name:
            self._standings.append(newest)
            self._formed = now
        for standing in self._standings:
            standing.told |= {tag for tag, names in self._last.items() if standing.name in names}
        version = self._bids[self.own][0]
        for standing in self._standings:
            if (standing.table[self.own] or (-1,))[0] == version:
                self._known_by |= standing.told & self._members
        self._agree(now)
        self._fold()
        self._entitle(now)

    def _agree(self, now: float) -> None:
        """Leave out all tables before the last one that is agreed on."""
        agreed = [i for i, standing in enumerate(self._standings) if self._counts(now, standing)]
        if not agreed or (agreed[-1] == 0 and not self._newcomer):
            return
        self._standings = self._standings[agreed[-1] :]
        self._newcomer, self._folded, self._agreed_at = False, UNIT, now
        self._round = now - self._formed
        for turn in self._standings[0].turns:
            turn.used = max(turn.used, now) if turn.number == 0 else turn.used

    def _counts(self, now: float, standing: Standing) -> bool:
        """Whether a table is agreed on. The first one of a newcomer must hold everybody's bid."""
        alone = not standing.bidders
        first = standing.complete and (not alone or (len(self._members) == 1 and now >= self._settled_at))
        return standing.agreed and (first or not self._newcomer)

    def _fold(self) -> None:
        while len(self._standings) > MOST_STANDING:
            self._folded = min(self._folded, self._standings.pop(1).total)

    def _entitled(self) -> int:
        """What all tables that count give us now [units]."""
        if self._newcomer:
            return self._floor // NEWCOMERS
        return min([self._folded, *(standing.total for standing in self._standings)])

    def _entitle(self, now: float, unused: float = 0.0) -> float | None:
        """Our part changes with what we are entitled to; return when we last used what we give up [s]."""
        before = self._steady.least(now)
        self._steady.lift(now, self._entitled(), min(unused, now - self._agreed_at))
        least = self._steady.least(now)
        return self._ledger.strike(now, least, before - least) if least < before else None

    def _hear_turns(self, now: float, peer: str, told: Told, standing: Standing) -> None:
        for turn, number in zip(standing.turns, told.turns, strict=False):
            if turn.heard(now, peer, number, told.unused):
                self._entitle(now, now - turn.used)

    def _shares(self, turn: Turn) -> bool:
        return any(tag == self.own for tag, _ in turn.slot.ring)

    def _turn_ends(self, turn: Turn) -> float:
        return turn.ends(self._window, self._news)

    def _is_over(self, now: float, turn: Turn) -> bool:
        """Whether we pass a slot on: at the end of our turn, or once its last window has been used."""
        ends = self._turn_ends(turn)
        spent = self._ledger.kept(now, 0) > self._steady.least(now) - turn.slot.size / 2
        return now >= ends or (spent and now >= ends - self._window)

    def _pass_on(self, now: float, turn: Turn) -> None:
        turn.number, turn.teller = turn.number + 1, self.own
        used = self._entitle(now)
        turn.used = turn.used if used is None else max(turn.used, used)
