"""Our part of what robots share: the protocol of `proxy.core.split`, for one robot."""

import math
import zlib
from collections.abc import Collection, Sequence

from proxy.core.protocol.bid import UNIT, Bid, alike
from proxy.core.protocol.parts import MOST_ASKED, Told
from proxy.core.split.agreement import Agreement
from proxy.core.split.ledger import Ledger
from proxy.core.split.steady import Steady
from proxy.core.split.turns import Turn

PATIENCE = 2.0
"""A bid changes no sooner after it changed last [s]; sooner in the first seconds, when streams become known."""
PACE = 2.0
"""Nor does it sooner after all agreed than so many times what agreeing took: a third of the time is for that."""
SILENT = 1.5
"""Who has nothing to ask for says so after so long, or when the bids of all others are known [s]."""
ASKING, WAYS = 1.0, 2.0
"""Who misses something asks for it after so long, and so many times what news take besides [s]; then twice as late."""
MOST_ASKS = 3
"""So often at most: it is never more than eight times as late."""


class Split:
    """One robot's part of every shared limit, by what it has heard so far.

    `windows` are those of the shared limits [s]. `floor` is the part of the limits that is kept for newcomers. At
    `settled_at` [s] all who are there have seen us: a robot that sees nobody then has everything. `kind` stands for
    what all must share to take part together (limits, specs); `version` is greater than any told under our tag before.
    Digests of a peer come in the order in which it sent them; late ones are left out by the caller.
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
    ) -> None:
        self._window, self._settled_at = max(windows), settled_at
        units = round(floor * UNIT)
        self._agreement = Agreement(own, now, floor=units, settled_at=settled_at, kind=kind, version=version)
        self._started, self._asked, self._news = now, -math.inf, 0.0
        self._phase = zlib.crc32(own.encode()) / 2**32
        """Who misses the same does not ask at the same moment: one asks for all."""
        self._told: Told | None = None
        self._told_at, self._met = now, math.inf
        """When we told last, and when we saw the first other robot [s]."""
        self._bid_told = -1, now
        """The version of our bid that was told last, and when [s]."""
        self._heard_at, self._asks = now, 0
        """When we last heard what is news, or asked for it [s], and how often we did since."""
        self._again = False
        """Whether we have to tell again, because we were asked to, or a slot was passed on and not taken."""
        self.passes_on = False
        """Whether that is for a slot: one robot waits for us alone."""
        self._quiet, self._settle_time = False, settled_at - now
        """Whether the team is too large to agree; how long it takes until all have seen that, or us [s]."""
        self._ledger = Ledger(windows)
        self._steady = Steady(now, self._agreement.entitled, self._window)

    def part(self, now: float, limit: int = 0) -> float:
        """Return what our sends within the window of a limit may use together, as a part of it.

        `now` may lie ahead: what it will be if nothing is heard and no turn ends.
        """
        return (self._steady.least(now) + self._ledger.struck(now, limit)) / UNIT

    def grows_at(self, now: float) -> float:
        """Return when our part grows next, if nothing is heard and no turn ends [s]; ∞ where it does not."""
        return self._steady.rises_at(now)

    def free(self, now: float, limit: int = 0) -> float:
        """Return what is left of our part of a limit now."""
        return max(0.0, self._steady.least(now) - self._ledger.kept(now, limit)) / UNIT

    @property
    def formed(self) -> bool:
        """Whether we have ever agreed on a table with everybody's bid."""
        return self._agreement.formed

    @property
    def least(self) -> float:
        """The least that any table gives us without slots, agreed on or not, as a part of the limit."""
        return self._agreement.own_part / UNIT

    @property
    def rivals(self) -> bool:
        """Whether another robot asks for anything, as far as we know."""
        return self._agreement.rivals

    @property
    def waits_for_turn(self) -> bool:
        """Whether we share slots of which none is ours now."""
        ours = [turn for turn in self._agreement.turns if any(tag == self._agreement.own for tag, _ in turn.slot.ring)]
        return bool(ours) and not self._held

    @property
    def settled(self) -> bool:
        """Whether all have agreed on the newest table, as far as we know; until then digests are worth sending."""
        return self.silent or self._agreement.settled

    def set_quiet(self, now: float, *, quiet: bool) -> None:
        """The team is too large to agree, or is not: we ask for nothing if any of our messages fits an equal part."""
        if quiet and not self._quiet:
            self._agreement.restart(now, now + self._settle_time)
            self._told, self._again = None, False
            self._entitle(now)
        self._quiet = quiet

    @property
    def silent(self) -> bool:
        """Whether we ask for nothing and tell nothing: the others leave us an equal part."""
        return self._quiet and not self._agreement.bid[1]

    def due_at(self, now: float) -> float:
        """Return when our part changes by time alone, or a turn ends [s]."""
        settles = self._settled_at if self._agreement.newcomer and now < self._settled_at else math.inf
        turns = [self._turn_ends(turn) for turn in self._held]
        asks = self._asks_at if self._asks_at > now else math.inf
        return min([self._steady.rises_at(now), self._ledger.next_expiry(now), settles, asks, *turns])

    def telling(self, now: float) -> Told:
        """Return what our next digest says."""
        agreement, (version, bid) = self._agreement, self._agreement.bid
        passed = [now - turn.used for turn in agreement.turns if turn.giver == agreement.own]
        missing = self._mask(agreement.missing) if now >= self._asks_at else 0
        return Told(
            version,
            None if agreement.known or self._just_told(now, version) else bid,
            agreement.standings[-1].name,
            0 if agreement.newcomer else agreement.standings[0].name,
            tuple(turn.number for turn in agreement.turns),
            min([self._window, *passed]),
            missing,
        )

    def _just_told(self, now: float, version: int) -> bool:
        """Whether our bid has just gone out: who missed it asks."""
        recent = self._bid_told[0] == version and now < self._bid_told[1] + self._patience
        return recent and not self._again

    def told(self, now: float, told: Told) -> None:
        """This goes out in a digest."""
        if told.missing:
            self._heard_at, self._asks = now, min(self._asks + 1, MOST_ASKS)
        self._told, self._told_at, self._again, self.passes_on = told, now, False, False
        self._agreement.told(told.table)
        self._entitle(now)
        if told.bid is not None:
            self._bid_told = told.version, now

    def has_news(self, now: float) -> bool:
        """Whether the others wait to hear from us: a bid, that we have everybody's, that a slot is passed on.

        A table that lacks bids is no news yet, for nobody else has it; nor is what others know sooner than we.
        """
        agreement, told = self._agreement, self._told
        if self.silent:
            return False
        if self._again or now >= self._asks_at:
            return True
        if told is None:
            return bool(agreement.bid[1]) or (agreement.complete and len(agreement.members) > 1)
        newest = agreement.standings[-1]
        return told.version != agreement.bid[0] or (newest.complete and told.table != newest.name)

    def bid(self, now: float, bid: Bid) -> bool:
        """Ask for this from now on, if it differs enough and it is time; return whether we do."""
        agreement = self._agreement
        if self.silent and any(not segment.quarters or segment.amount <= agreement.equal for segment in bid):
            return False
        same = alike(agreement.bid[1], bid)
        if not self._may_ask(now) or ((same or agreement.indifferent(bid)) and not agreement.starves(bid)):
            return False
        self._asked = now
        agreement.ask(now, bid)
        self._settle(now)
        return True

    def begin(self, now: float) -> None:
        """From now on digests tell of parts; what was told while the team split before was long ago."""
        self._met, self._told = now, None

    def set_members(self, now: float, tags: Collection[str]) -> None:
        """These robots take part, as far as we see."""
        if tags:
            self._met = min(self._met, now)
        self._agreement.set_members(now, tags)
        self._settle(now)

    def heard(self, now: float, peer: str, told: Told, sent: float = -math.inf) -> None:
        """A digest of another robot came, newer than all before, which was sent at `sent` [s]."""
        missing = self._agreement.missing
        self._agreement.heard(now, peer, told.version, told.bid, (told.table, told.agreed))
        self._again |= bool(told.missing & self._mask({self._agreement.own})) and sent > self._told_at + self._news
        for standing in self._agreement.standings:
            for turn, number in zip(standing.turns, told.turns if standing.name == told.agreed else (), strict=False):
                if turn.heard(now, peer, number, told.unused):
                    self._entitle(now, now - turn.used)
        self._settle(now)
        if self._agreement.missing != missing:
            self._heard_at, self._asks = now, 0
        ours = self._mask(self._agreement.missing)
        if ours and told.missing & ours == ours:
            self._heard_at = now

    def sent(self, now: float, uses: Sequence[float]) -> bool:
        """We sent a message that uses such parts of the shared limits; return whether we passed a slot on.

        One that is larger than our part has the windows until all of it would have fitted for itself.
        """
        times = max([1.0, *(use / max(self.part(now, limit), 1 / UNIT) for limit, use in enumerate(uses))])
        self._ledger.sent(now + (times - 1.0) * self._window, [use * UNIT / times for use in uses])
        return self.look(now, self._news)

    def look(self, now: float, news: float) -> bool:
        """Time passed; news take so long to others [s]. Return whether we passed a slot on."""
        self._news = news
        if self._agreement.newcomer and now >= self._settled_at:
            self._settle(now)
        over = [turn for turn in self._held if self._is_over(now, turn)]
        for turn in over:
            self._pass_on(now, turn)
        self.passes_on |= bool(over) or any(self._is_lost(now, turn) for turn in self._agreement.turns)
        self._again |= self.passes_on
        return bool(over)

    @property
    def _asks_at(self) -> float:
        """When we ask for what we miss [s]; never where we miss nothing."""
        if self._quiet or not self._agreement.missing:
            return math.inf
        if self._told is None:
            return self._met + SILENT
        return max(self._heard_at, self._told_at) + self._patience * (1.0 + self._phase) * 2.0**self._asks

    @property
    def _patience(self) -> float:
        """How long we wait for what we miss [s]."""
        return ASKING + WAYS * self._news

    def _mask(self, tags: set[str]) -> int:
        """Return a bit for each of some robots, as far as there are bits for them."""
        members = sorted(self._agreement.members)
        return sum(1 << place for place, tag in enumerate(members[:MOST_ASKED]) if tag in tags)

    @property
    def _held(self) -> list[Turn]:
        return [turn for turn in self._agreement.turns if turn.holder == self._agreement.own]

    def _may_ask(self, now: float) -> bool:
        """Whether our bid may change: at first, then once all have agreed on the last table, and some time later."""
        agreement, patience = self._agreement, min(PATIENCE, (now - self._started) / 2)
        soonest = max(self._asked + patience, agreement.since + PACE * agreement.took)
        return self._asked == -math.inf or (not agreement.pending and now >= soonest)

    def _settle(self, now: float) -> None:
        self._agreement.settle(now)
        self._entitle(now)

    def _entitle(self, now: float, unused: float = 0.0) -> None:
        """Our part changes with what we are entitled to; what it rises by has been unused for so long [s]."""
        before = self._steady.least(now)
        self._steady.lift(now, self._agreement.entitled, min(unused, now - self._agreement.since))
        self._strike(now, before)

    def _strike(self, now: float, before: int) -> None:
        """Our part was so much before."""
        if (least := self._steady.least(now)) < before:
            self._ledger.strike(now, least, before - least)

    def _turn_ends(self, turn: Turn) -> float:
        """A turn lasts as long as a message that has several windows for itself."""
        return max(turn.ends(self._window, self._news), self._ledger.last)

    def _is_over(self, now: float, turn: Turn) -> bool:
        """Whether we pass a slot on: at the end of our turn, or once its last window has been used."""
        ends = self._turn_ends(turn)
        spent = self._ledger.kept(now, 0) > self._steady.least(now) - turn.slot.size / 2
        return now >= ends or (spent and self._ledger.last <= now and now >= ends - self._window)

    def _is_lost(self, now: float, turn: Turn) -> bool:
        """Whether we passed a slot on, and nobody says that its next turn is over though it should be."""
        ours = turn.giver == self._agreement.own
        return ours and now >= max(turn.ends(self._window, self._news), self._told_at) + 2.0 * self._patience

    def _pass_on(self, now: float, turn: Turn) -> None:
        """It is the next one's turn: what we sent and has no room beside this slot was sent in it."""
        before = self._steady.least(now)
        turn.number += 1
        self._steady.give_up(now, self._agreement.entitled, turn.slot.size, self._agreement.own_part)
        self._strike(now, before)
        turn.used = max(turn.used, self._ledger.last_struck)
