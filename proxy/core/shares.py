"""Shares: who may use how much of each limit, so that the union holds at any latency.

One robot, the *leader*, holds all of every limit less a floor, and lends: a grant lets a robot send so much between two
times of the leader's clock. The leader counts it as gone from the first of them until one window after the second,
when what was sent last has left every window; it never lends what it lent, nor what its own sends still use. A robot
uses only what it was told, and takes the times narrower by what it may be wrong about the leader's clock. So what all
use never exceeds the limit, however late digests are and however many are lost: a grant that nobody hears is wasted,
and one that ends needs no message. What is not shared, such as a robot's own energy, everybody holds whole.

Who leads is agreed on by *epochs* (`epochs.py`). A newcomer has a part of the floor until it enters its first epoch. A
robot not heard keeps what it was lent; nobody else was lent that. Two teams that meet have two leaders until they hear
each other, and for one window more.
"""

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

from proxy.core.epochs import EDGE, NEWCOMERS, Epochs
from proxy.core.given_back import Borrowed, GivenBack, last_digits
from proxy.core.limits import Limit
from proxy.core.wire import PARTS, Grant, Returned

HOLDABLE = 0.98
"""Part of a limit that one robot can come to hold: all but the floor, and some room."""
MOST_GRANTS = 1024
"""Grants that can be alive at the same time."""
ALL = 0.99
"""Who may send a message larger than the limit was lent all that robots can hold, or lacks no more than rounding."""
LONG = 2.5
"""What is lent for so long at once is lent for more than one message [s]."""


@dataclass(frozen=True, slots=True)
class Lent:
    """So much of every shared limit may be sent between two times of our clock [s], both included."""

    robot: str
    begins: float
    ends: float
    amounts: tuple[float, ...]
    lead: float = 0.0
    """So long before, nobody else may send either: it is for a message larger than a limit [s]."""
    unsure: float = 0.0
    """So much less of the time is ours than was lent, for what clocks may be wrong by [s]."""

    @property
    def since(self) -> float:
        """From then on it is nobody else's [s]."""
        return self.begins - self.lead

    @property
    def stays(self) -> bool:
        """Whether it is a slot, which is lengthened as a rule before it ends."""
        return self.ends - self.begins + self.unsure >= LONG

    def at(self, t: float, k: int, window: float) -> float:
        """What of constraint `k` belongs to the robot at a time, for sends within the window that ends then."""
        return self.amounts[k] if self.begins <= t <= self.ends + window else 0.0


class Shares:
    """What this robot holds, uses and lends of every constraint. Peers are named by their tags."""

    def __init__(
        self,
        own: str,
        limits: tuple[Limit, ...],
        *,
        floor: float,
        settled_at: float,
        started: float | None = None,
    ) -> None:
        self.own = own
        self._limits = limits
        self._floor = floor
        self._epochs = Epochs(
            own, limits, settled_at=settled_at, started=started, turned=self._turned, left_at=self._left_at
        )
        self._lent: list[Lent] = []
        self._told: dict[Grant, float] = {}
        """Grants that we made, or heard of: these are remembered for as long as they could come again."""
        self._borrowed: dict[Borrowed, Lent] = {}
        self._given_back = GivenBack()
        self._factors = [1.0] * len(limits)
        self._sent: deque[tuple[float, tuple[float, ...]]] = deque()

    @property
    def epoch(self) -> int:
        """The epoch that we are in; 0: none."""
        return self._epochs.epoch

    @property
    def leader(self) -> str:
        """Who lends in our epoch; nobody while empty."""
        return self._epochs.leader

    @property
    def members(self) -> frozenset[str]:
        """Tags of the robots that share, our own included."""
        return self._epochs.members

    @property
    def leads(self) -> bool:
        """Whether it is we who lend."""
        return self._epochs.leads

    @property
    def stragglers(self) -> list[str]:
        """Robots that are not known to be in our epoch."""
        return self._epochs.stragglers

    def knows(self, epoch: int, names: Iterable[str]) -> bool:
        """Whether an epoch is one of our limits, with one of these robots, or us, as the one who leads."""
        return self._epochs.knows(epoch, names)

    def due_at(self, now: float) -> float:
        """When time alone changes who lends [s]."""
        return self._epochs.due_at(now)

    def set_members(self, now: float, members: Iterable[str]) -> None:
        """The robots on the mesh are now these (ours is added)."""
        self._epochs.set_members(now, members)

    def set_limits(self, now: float, limits: tuple[Limit, ...]) -> None:
        """The constraints are now these; what we sent still counts. Other ceilings need another epoch."""
        if limits == self._limits:
            return
        before = {_identity(limit): k for k, limit in enumerate(self._limits)}
        places = [before.get(_identity(limit)) for limit in limits]
        self._sent = deque((t, tuple(0.0 if k is None else use[k] for k in places)) for t, use in self._sent)
        self._factors = [1.0 if k is None else self._factors[k] for k in places]
        self._limits = limits
        self._epochs.set_limits(now, limits, free=not self.lent(now))

    def set_factor(self, k: int, factor: float) -> None:
        """Of constraint `k` this part is in force, from 0 to 1: who leads lends no more, and nobody uses more.

        What is lent already stays lent: grants are for whole messages, and soon over.
        """
        self._factors[k] = min(1.0, max(0.0, factor))

    def heard(
        self,
        now: float,
        peer: str,
        epoch: int,
        grants: Iterable[Grant] = (),
        *,
        ours: Callable[[float], float] = lambda t: t,
        uncertainty: float = 0.0,
    ) -> None:
        """Take in that `peer` is in `epoch`, and what it lends there; `ours` maps its clock to ours, give or take."""
        if self._epochs.heard(now, peer, epoch):
            for grant in grants:
                self._borrow(now, grant, ours, uncertainty)

    def forget(self, peer: str) -> None:
        """A robot left: what it last said of its epoch no longer counts."""
        self._epochs.forget(peer)

    def look(self, now: float) -> None:
        """Do what is due: enter an epoch, or lead if nobody does, and forget what is over."""
        self._epochs.look(now)
        self._lent = list(self.lent(now))
        if self.leads:
            self._told = {grant: ends for grant, ends in self._told.items() if ends > now}

    def confirmed(self, now: float) -> bool:
        """Whether somebody lends; if it is we, whether we may."""
        return self._epochs.confirmed(now)

    def held(self, now: float, k: int) -> float:
        """What we may use of constraint `k` within the window that ends now [its units]."""
        limit = self._limits[k]
        if not limit.shared:
            return self._in_force(k)
        if not self.epoch and not self.confirmed(now):
            return self._floor / NEWCOMERS * limit.limit
        return self._share(now, k) if not self.leads or self.confirmed(now) else 0.0

    def whole(self, k: int) -> float:
        """What all robots together may come to hold of constraint `k` [its units]."""
        return (1.0 - self._floor if self._limits[k].shared else 1.0) * self._in_force(k)

    def used(self, t: float, k: int) -> float:
        """What our sends of the window that ends at a time use of constraint `k`."""
        since = t - self._limits[k].window
        return sum(use[k] for sent, use in self._sent if sent >= since)

    def free(self, now: float, k: int) -> float:
        """What we may still send now of constraint `k`: it has to fit what we hold for a whole window."""
        return max(0.0, self._free(now, now, k))

    def fits(self, now: float, use: tuple[float, ...]) -> bool:
        """Whether a message with this use may be sent now."""
        return not self.lacking(now, use)

    def lacking(self, now: float, use: tuple[float, ...]) -> list[int]:
        """Return the constraints that leave no room for a message with this use now."""
        return [k for k, amount in enumerate(use) if not self._fits(now, now, k, amount)]

    def holds(self, now: float, t: float, use: tuple[float, ...]) -> bool:
        """Whether what a message takes that is sent at a time to come would be of what is lent to us already."""
        if self.leads:
            return all(
                self._claim(k, each) <= self._share(t, k) for k, each in enumerate(use) if self._limits[k].shared
            )
        begun = [lent for lent in self._lent if lent.begins <= now]
        return all(
            self._claim(k, amount) <= sum(lent.amounts[k] for lent in begun if t <= lent.ends or lent.stays)
            for k, amount in enumerate(use)
            if self._limits[k].shared
        )

    def stays(self, now: float) -> bool:
        """Whether what we hold is ours for longer than the next message: slots, or where we lead what is left."""
        return self.leads or any(lent.stays for lent in self._lent if lent.begins <= now <= lent.ends)

    def opens(self, now: float, use: tuple[float, ...], until: float) -> float | None:
        """When a message with this use may be sent by what we know, in (now, until]; None when it may not."""
        times, lead = {lent.begins for lent in self._lent if not self.leads}, self._lead(use)
        times |= {lent.ends + EDGE + w + lead + 1e-6 for lent in self._lent for w in self._windows() if self.leads}
        times |= {t + w + lead + 1e-6 for t, _ in self._sent for w in self._windows()}
        for t in sorted(t for t in times if now < t <= until):
            if all(self._fits(t, now, k, amount) for k, amount in enumerate(use)):
                return t
        return None

    def use(self, now: float, use: tuple[float, ...]) -> None:
        """A message with this use is sent now."""
        self._sent.append((now, use))
        longest = max((self._window(k) for k in range(len(self._limits))), default=0.0)
        while self._sent and self._sent[0][0] < now - longest:
            self._sent.popleft()
        self._spend(now, use)

    def use_at_most(self, now: float, use: tuple[float, ...], part: float) -> None:
        """Traffic that nobody decided on is sent now; it counts up to `part` of what we hold, the rest is left."""
        self.look(now)
        room = (part * self.held(now, k) - self.used(now, k) for k in range(len(self._limits)))
        self.use(now, tuple(max(0.0, min(amount, left)) for amount, left in zip(use, room, strict=True)))

    def returned(self, now: float) -> tuple[Returned, ...]:
        """What we give back to who lends and did not tell often enough."""
        for place, lent in list(self._borrowed.items()):
            if lent.ends < now and not lent.stays and lent in self._lent:
                self._give_back(now, place, None)
        return self._given_back.untold()

    def told_returned(self) -> None:
        """Who lends was told once what we give back."""
        self._given_back.told()

    def take_back(
        self,
        peer: str,
        epoch: int,
        returned: Iterable[Returned],
        latest: Callable[[float], float] = lambda t: t,
    ) -> list[Lent]:
        """A robot gives back what we lent to it; return what of it was not used at all.

        `latest` is what our clock showed at most when that of the robot showed a time.
        """
        unused: list[Lent] = []
        if not self.leads or epoch != self.epoch:
            return unused
        named = {each.begins: each for each in returned}
        for lent in [each for each in self._lent if each.robot == peer and not each.stays] if named else ():
            back = named.get(last_digits(lent.begins))
            if back is None:
                continue
            ends = max(lent.begins, _rounded(latest(back.used)) + EDGE)
            if back.used and ends >= lent.ends:
                continue
            self._lent.remove(lent)
            if back.used:
                self._lent.append(replace(lent, ends=ends))
            else:
                unused.append(lent)
            self._told = {g: e for g, e in self._told.items() if (g.peer, g.begins) != (peer, lent.begins)}
        return unused

    def sent(self) -> tuple[tuple[float, tuple[float, ...]], ...]:
        """Our sends that may still count, as (time, use), oldest first."""
        return tuple(self._sent)

    def reserved(self, use: tuple[float, ...]) -> float:
        """How long before a message larger than a limit nobody else may send [s]; 0 for every other one."""
        return max((self._reserved(k, a) for k, a in enumerate(use) if self._exceeds(k, a)), default=0.0)

    def lend(
        self, now: float, peer: str, earliest: float, latest: float, use: tuple[float, ...], *, lasting: float = 0.0
    ) -> Lent | None:
        """Let `peer` send `use`, of the shared limits, until `latest`, for `lasting` at least; None if none is left.

        It may from as early on as can be, but not before `earliest` [s]. What exceeds a limit is lent all of it, and
        nobody else anything from as long before as such a message needs.
        """
        if not self.leads or not self.confirmed(now) or peer not in self.members - {self.own}:
            return None
        parts = tuple(self._parts(k, amount) for k, amount in enumerate(use))
        amounts = tuple(min(self._amount(k, part), self.whole(k)) for k, part in enumerate(parts))
        lead = self._lead(use)
        last = _rounded(latest)
        taken = {e.begins for e in self._lent if e.robot == peer}
        for chance in self._chances(max(now, earliest), last, lead):
            begins = chance
            while begins in taken:
                begins = _rounded(begins + 1.5 * EDGE)
            ends = max(last, _rounded(begins + lasting)) if lasting else last
            if len(self._lent) < MOST_GRANTS and self._lendable(begins - lead, ends, amounts):
                lent = Lent(peer, begins, ends, amounts, lead)
                self._lent.append(lent)
                self._told[Grant(peer, begins, ends, parts)] = ends
                return lent
        return None

    def lengthen(self, now: float, lent: Lent, latest: float) -> Lent | None:
        """Let a robot use until `latest` what it was lent for less; None when that is not left.

        There is one of these times of begin and amounts, so the robot knows which of what it was lent is meant.
        """
        if not self.leads or not self.confirmed(now) or lent not in self._lent:
            return None
        longer = replace(lent, ends=_rounded(latest))
        self._lent.remove(lent)
        if longer.ends > lent.ends and self._lendable(max(lent.begins, _rounded(now)), longer.ends, lent.amounts):
            self._lent.append(longer)
            limits = (limit.measure.limit for limit in self._limits)
            parts = tuple(round(amount * PARTS / limit) for amount, limit in zip(lent.amounts, limits, strict=False))
            self._told = {g: e for g, e in self._told.items() if (g.peer, g.begins) != (lent.robot, lent.begins)}
            self._told[Grant(lent.robot, lent.begins, longer.ends, parts)] = longer.ends
            return longer
        self._lent.append(lent)
        return None

    def lent(self, now: float) -> tuple[Lent, ...]:
        """What of ours is lent and not yet back."""
        longest = max(self._windows(), default=0.0)
        return tuple(lent for lent in self._lent if lent.ends + longest + EDGE >= now)

    def grants(self, now: float) -> tuple[Grant, ...]:
        """All that we lend and that can still be used, for the digest."""
        return tuple(grant for grant, ends in self._told.items() if ends > now) if self.leads else ()

    def _free(self, t: float, now: float, k: int) -> float:
        """What may be sent at `t` of constraint `k`, if until then nothing is: the least room of the window after."""
        window = self._limits[k].window
        edges = {lent.since - EDGE if self.leads else lent.ends + window + 1e-9 for lent in self._lent}
        times = [t, *(edge for edge in edges if t < edge <= t + window)]
        own = self._limits[k].shared
        return min(self._held_at(at, now, k) - self.used(at, k) for at in (times if own else [t]))

    def _held_at(self, t: float, now: float, k: int) -> float:
        """What we hold at a time to come, by what we know now."""
        limit = self._limits[k]
        if not limit.shared or not self.epoch or (self.leads and not self.confirmed(now)):
            return self.held(now, k)
        return self._share(t, k)

    def _share(self, t: float, k: int) -> float:
        """What is ours at a time of a shared constraint: what is left of it, or what is lent to us."""
        if self.leads:
            return max(0.0, self.whole(k) - self._gone(t, k))
        return min(sum(lent.at(t, k, self._limits[k].window) for lent in self._lent), self._in_force(k))

    def _in_force(self, k: int) -> float:
        return self._factors[k] * self._limits[k].limit

    def _gone(self, t: float, k: int) -> float:
        """What of constraint `k` others may use at a time."""
        window = self._limits[k].window
        return sum(e.amounts[k] for e in self._lent if e.since - EDGE <= t <= e.ends + window + EDGE)

    def _chances(self, earliest: float, latest: float, lead: float) -> list[float]:
        """When a grant could begin: at once, or when something comes back."""
        windows = self._windows()
        times = [e.ends + w + lead + 2.1 * EDGE for e in self._lent for w in windows]
        times += [t + w + lead + 2.1 * EDGE for t, _ in self._sent for w in windows]
        first = _rounded(earliest) + EDGE
        return [first, *sorted({_rounded(t) + EDGE for t in times if earliest < t < latest})]

    def _lendable(self, begins: float, ends: float, amounts: tuple[float, ...]) -> bool:
        """Whether so much is left from the beginning to one window after the end."""
        if ends <= begins:
            return False
        for k, amount in enumerate(amounts):
            last = ends + self._limits[k].window + EDGE
            first = begins - EDGE
            times = [first, *(e.since - EDGE for e in self._lent if first < e.since - EDGE <= last)]
            if any(self._gone(t, k) + self.used(t, k) + amount > self.whole(k) * (1 + 1e-9) for t in times):
                return False
        return True

    def _borrow(self, now: float, grant: Grant, ours: Callable[[float], float], uncertainty: float) -> None:
        """The leader lends: to us, if it is for us, and between the times that lie within for certain."""
        if grant.peer != self.own or grant in self._told or len(grant.parts) != sum(c.shared for c in self._limits):
            return
        longest = max(self._windows(), default=0.0)
        place = grant.begins, grant.parts
        self._given_back.forget(now - longest)
        if place in self._given_back:
            return  # who lends has not heard yet that we gave it back
        self._told = {known: ends for known, ends in self._told.items() if ends + longest + 1.0 > now}
        self._lent = [lent for lent in self._lent if lent.ends + longest >= now]
        begins, ends = ours(grant.begins) + uncertainty, ours(grant.ends) - uncertainty
        if begins <= ends and ends >= now and len(self._lent) < MOST_GRANTS:
            self._told[grant] = ends
            amounts = tuple(self._amount(k, part) for k, part in enumerate(grant.parts))
            self._borrowed = {known: lent for known, lent in self._borrowed.items() if lent in self._lent}
            if (shorter := self._borrowed.get(place)) is not None:
                begins, ends = min(begins, shorter.begins), max(ends, shorter.ends)
                self._lent.remove(shorter)
            unsure = grant.ends - grant.begins - (ends - begins)
            self._borrowed[place] = Lent(self.own, begins, ends, amounts, unsure=unsure)
            self._lent.append(self._borrowed[place])

    def _spend(self, now: float, use: tuple[float, ...]) -> None:
        """What was lent for the message that is sent now has served."""
        if self.leads:
            return
        left = list(use)
        begun = [(place, lent) for place, lent in self._borrowed.items() if lent in self._lent and not lent.stays]
        for place, lent in sorted(begun, key=lambda each: each[1].ends):
            if lent.begins <= now <= lent.ends and any(left[k] > 0.0 for k in range(len(lent.amounts))):
                left[: len(lent.amounts)] = [a - b for a, b in zip(left, lent.amounts, strict=False)]
                self._give_back(now, place, now)

    def _give_back(self, now: float, place: Borrowed, used: float | None) -> None:
        """Hold nothing any more of what we were lent but for what we sent, if all that we sent still fits then."""
        lent = self._borrowed.pop(place)
        where = self._lent.index(lent)
        self._lent[where : where + 1] = [] if used is None else [replace(lent, ends=used)]
        shared = [k for k, limit in enumerate(self._limits) if limit.shared]
        if any(self._free(now, now, k) < 0.0 for k in shared):
            self._lent[where : where + (used is not None)], self._borrowed[place] = [lent], lent
        else:
            self._given_back.add(place, lent.ends, used)

    def _parts(self, k: int, amount: float) -> int:
        """An amount in parts of the ceiling, which all robots agree on; at most all of it."""
        return int(-(-min(amount, self.whole(k)) * PARTS // self._limits[k].measure.limit))

    def _amount(self, k: int, parts: int) -> float:
        return parts * self._limits[k].measure.limit / PARTS

    def _fits(self, t: float, now: float, k: int, amount: float) -> bool:
        """Eq. 5 against what we hold; a message larger than anybody could hold has a window stretched for it."""
        limit = self._limits[k]
        if not self._exceeds(k, amount):
            return amount <= self._free(t, now, k)
        if limit.shared and not self.confirmed(now):
            return False
        shared = limit.shared
        since = t - (self._reserved(k, amount) if shared else self._stretched(k, amount))
        quiet = not any(sent >= since and use[k] > 0.0 for sent, use in self._sent)
        return quiet and (not shared or self._has_all(t, k, since))

    def _has_all(self, t: float, k: int, since: float) -> bool:
        """Whether nobody else may send between a time and one window after `t`, as a message at `t` needs it."""
        if not self.leads:
            return any(e.begins <= t <= e.ends and e.amounts[k] >= ALL * self.whole(k) for e in self._lent)
        last = t + self._limits[k].window + EDGE
        return not any(e.since <= last and e.ends + EDGE >= since for e in self._lent)

    def _exceeds(self, k: int, amount: float) -> bool:
        """Whether a message is larger than what anybody could hold."""
        return amount > (HOLDABLE if self._limits[k].shared else 1.0) * self._in_force(k)

    def _claim(self, k: int, amount: float) -> float:
        """What must be lent for a message."""
        return ALL * self.whole(k) if self._exceeds(k, amount) else amount

    def _lead(self, use: tuple[float, ...]) -> float:
        """So much longer than the window has to be empty before a message larger than a limit [s]."""
        shared = (k for k in range(len(use)) if self._limits[k].shared)
        return max((self._reserved(k, use[k]) - self._limits[k].window for k in shared), default=0.0)

    def _reserved(self, k: int, amount: float) -> float:
        """The window before a message; of one larger than the limit, as long as its bytes take [s]."""
        return self._limits[k].window * max(1.0, amount / max(self.whole(k), 1e-9))

    def _windows(self) -> list[float]:
        return [limit.window for limit in self._limits if limit.shared]

    def _window(self, k: int) -> float:
        """How far back a send may count: the window, or what the largest message stretched it to."""
        return self._stretched(k, max((use[k] for _, use in self._sent), default=0.0))

    def _stretched(self, k: int, amount: float) -> float:
        """The window in which a message may be alone, if all robots send such messages [s]; at least the window."""
        limit = self._limits[k]
        users = len(self.members) if limit.shared else 1
        return limit.window * max(1.0, amount * users / max(self._in_force(k), 1e-9))

    def _turned(self) -> None:
        """What was lent before counts no more."""
        self._lent, self._told, self._borrowed, self._given_back = [], {}, {}, GivenBack()

    def _left_at(self, now: float) -> float:
        """When all that we sent of what is shared has left the windows [s]."""
        shared = [k for k, limit in enumerate(self._limits) if limit.shared]
        longest = max(self._windows(), default=0.0) + EDGE
        return max((t + longest for t, use in self._sent if any(use[k] > 0.0 for k in shared)), default=now)


def _identity(limit: Limit) -> tuple[str, str]:
    """What makes a constraint the same one under new specs: amounts of another kind are in another unit."""
    return limit.name, limit.measure.kind


def _rounded(t: float) -> float:
    """A time in whole milliseconds, as it travels [s]."""
    return int(t * 1000.0) / 1000.0
