"""What may still be sent: the constraints in force, what already counts against them, and which part of each is ours.

In `announce` all that is known to be sent counts, in `split` only our own sends; what is not shared each has whole.
"""

import math
from dataclasses import replace

from proxy.core.coordination.coordination import Coordination
from proxy.core.coordination.equal_parts import NOT_NEEDED
from proxy.core.coordination.sends import OthersSends, OwnSends
from proxy.core.coordination.stretch import Stretch
from proxy.core.coordination.tuning import TUNING
from proxy.core.market.room import Departures, Openings
from proxy.core.market.tuning import TUNING as MARKET
from proxy.core.model.limits import (
    Limit,
    Limits,
    Send,
    changes_plans,
    is_bulky,
    longest_window,
    stretched,
)
from proxy.core.view.view import SharedView


class Budget:
    """The limits in force, and what is left of them. Constraints are named by their places in `limits`."""

    def __init__(self, view: SharedView, coordination: Coordination) -> None:
        self._view = view
        self.coordination, self.hollow = coordination, coordination.hollow
        self.limits: tuple[Limit, ...] = ()
        """The constraints in force for all robots together, adaptive ones as the channel bears them."""
        self._memory = 0.0
        """How long sends are remembered [s]."""
        self.own = OwnSends()
        self._others = OthersSends(view)
        self.stretch = Stretch(self.own, self._others)
        self._mute_until = -math.inf
        """When the allowance has room for announcements [s]."""
        self._usable_for: tuple[tuple[Limit, ...], tuple[float, ...]] = (), ()
        self._usable: tuple[Limit, ...] = ()
        self._others_known: tuple[float, int, tuple[Limit, ...], bool] = (-math.inf, 0, (), False)
        """When, after how many notes, under which limits and in which coordination others had sent `_others_sent`."""
        self._others_sent: tuple[Send, ...] = ()
        self._openings = {False: Openings(), True: Openings()}
        """Of room that our own sends leave, and of what anybody's do."""

    @property
    def alone(self) -> bool:
        """Whether what may be used is our part, so that only our own streams compete for it."""
        return self.coordination.keeps > 0.0 or self.coordination.binds

    @property
    def turns(self) -> bool:
        """Whether all have parts: messages that are larger go by turns, or where a longer window is empty."""
        return self.alone and not self.coordination.keeps

    def set_limits(self, limits: tuple[Limit, ...], now: float = -math.inf) -> None:
        """Put these constraints in force now [s]; what we sent still counts against those of the same name and kind.

        Where the specs set less, that is the part of the limit that it was: as an operator lowered 1 Mbit/s to 0.2 (20
        in windows of 30 s to 3), four robots with cameras sent next to nothing for 12 s (nothing for 6 and more). That
        stays so if the limit is raised again: who sets 1 Mbit/s to 0.2 and back within a window allows 1.8 limits in
        it. Where limits follow the channel it is that part in both directions, so that what is sent follows at once:
        after each decrease two robots sent nothing for up to half a second, and so 5 % of odometry, of which 0.4 % are
        left.
        """
        if limits == self.limits:
            return
        before = {_identity(limit): k for k, limit in enumerate(self.limits)}
        places = [before.get(_identity(limit)) for limit in limits]
        if places != list(range(len(self.limits))):
            self.own.renumber(places)
            self._others.renumber(places)
            self.stretch.weigh((), (), ())
        parts = [0.0 if k is None else _part(self.limits[k], c) for k, c in zip(places, limits, strict=True)]
        sent = bool(self.own or self._view.traffic.sends)
        if now > -math.inf and sent and any(part != 1.0 for part in parts):
            self.own.begin_anew(parts, limits)
            self._others.begin_anew(now, parts, limits)
        self.limits, self._memory = limits, TUNING.stretched_windows * longest_window(limits)

    def mute(self, until: float) -> None:
        """Before then nothing may be sent that others have to hear of at once [s]: the allowance has no room for it."""
        self._mute_until = until

    def whole(self, now: float, k: int) -> float:
        """What may be used within the window that ends now, by us in `split`, else by all [units of the constraint]."""
        limit = self.limits[k]
        if not limit.shared:
            return limit.limit
        return max(TUNING.least_limit, limit.limit * self.coordination.part(now, k))

    def usable(self, now: float) -> tuple[Limit, ...]:
        """The constraints as they bind us now."""
        wholes = tuple([self.whole(now, k) for k in range(len(self.limits))])
        known = self.limits, wholes
        if known != self._usable_for:
            self._usable_for = known
            self._usable = tuple(replace(c, limit=whole) for c, whole in zip(self.limits, wholes, strict=True))
        return self._usable

    def used(self, now: float, k: int) -> float:
        """What our own sends of the window that ends now use."""
        return self.own.used(now - self.limits[k].window, k)

    def free(self, now: float, use: tuple[float, ...] = ()) -> list[float]:
        """What may still be sent now of each constraint; less than nothing where too much was sent.

        By a message with this use, else by one that is neither small nor larger than a limit.
        """
        usable = self.usable(now)
        free = [self._room(now, k, amount, usable) for k, amount in enumerate(use or self.stretch.ordinary(usable))]
        part = self.coordination.meanwhile.confined
        return free if part >= 1.0 else [min(room, _confined(self, now, k, part)) for k, room in enumerate(free)]

    def lacking(self, now: float, use: tuple[float, ...], total: tuple[float, ...] = ()) -> tuple[str, ...]:
        """Name the constraints that leave no room for a message with this use now, or the `total` it goes with."""
        if now < self._mute_until and changes_plans(use, self.limits):
            return tuple(limit.name for limit in self.limits if limit.shared)
        usable = self.usable(now)
        return tuple(
            [
                limit.name
                for k, (limit, message, amount) in enumerate(zip(usable, use, total or use, strict=True))
                if not self._fits(now, k, message, amount, usable)
            ]
        )

    def certain_at(self, now: float, use: tuple[float, ...]) -> float:
        """Return when a small message is within the part that is ours whatever others say [s]; ∞: it is not small.

        And within what is ours alone, of which it takes as little, for our own streams compete for that: of two robots
        with energy for two frames a second each sent any that fitted, and both reached half of what either does alone.
        In the past where it is now.
        """
        part, at = _certain(self._view, self.coordination), -math.inf
        if self.alone or part <= 0.0:
            return math.inf
        for k, limit in enumerate(self.limits):
            whole = self.whole(now, k)
            if use[k] > whole * (part if limit.shared else TUNING.certain_part) * TUNING.certain_message:
                return math.inf
            room = whole * part if limit.shared else whole
            at = max(at, self.own.exceeded_since(k, room - use[k]) + limit.window + MARKET.closed)
        return at

    def by_turn(self, now: float, use: tuple[float, ...]) -> bool:
        """Whether a message goes by turns of the clock: in ours it takes nothing from anybody."""
        coordination = self.coordination
        return coordination.equal.by_clock and _next_turn(self, coordination, now, use) > -math.inf

    def opens(
        self, now: float, use: tuple[float, ...], total: tuple[float, ...] = (), *, anybodys: bool = False
    ) -> float:
        """When room opens for a message, or the `total` it goes with [s]; −∞: it is there, ∞: never is.

        Room that our own sends leave, unless `anybodys` will do.

        Or when it can be announced: who only looked for room dropped alarms at once that could wait for seconds.
        Or when our part grows that is too small for it: in `split` ten robots with equal messages reach 83 to 95 % of a
        central decider, and 82 to 93 where such a sample was dropped.
        """
        needed, coordination = total or use, self.coordination
        if now < self._mute_until and changes_plans(use, self.limits):
            return self._mute_until
        if coordination.equal.by_clock and (turn := _next_turn(self, coordination, now, needed)) > -math.inf:
            return turn if self.lacking(now, use, needed) else -math.inf
        usable = self.usable(now)
        if all(amount <= self._room(now, k, use[k], usable, MARKET.closed) for k, amount in enumerate(needed)):
            return -math.inf
        others = self.others(now)
        limits = usable if self.turns else self.stretch.limits(now, usable, use, alone=self.alone)
        since = now - longest_window(limits) - MARKET.closed
        departures = self._openings[anybodys].after(since, self.own, others, anybodys=anybodys)
        opening = departures.opens(limits, needed)
        if limits is not usable and self.stretch.is_ordinary(use, usable):
            beside = [self.stretch.beside(sends, usable) for sends in (self.own, others)]
            opening = max(opening, Departures(*beside, anybodys=anybodys).opens(usable, needed))
        if opening < math.inf or math.isinf(grows := coordination.grows_at(now)):
            return opening
        return max(grows, departures.opens(self.usable(grows), needed))

    def use(self, now: float, use: tuple[float, ...], sample: int | None = None) -> None:
        """A message with this use is sent now, a `sample` or something else."""
        large = sample is not None and changes_plans(use, self.limits)
        self.own.note(now, use, sample if large else None, bulky=is_bulky(use, self.usable(now)))
        shared = [amount / limit.limit for amount, limit in zip(use, self.limits, strict=True) if limit.shared]
        self.coordination.sent(now, shared)
        self.own.forget(now - self._memory)

    def use_at_most(self, now: float, use: tuple[float, ...], part: float) -> None:
        """Traffic that nobody decided on is sent now; it counts up to `part` of what is ours, the rest is left."""
        limits, counts = self.usable(now), list[float]()
        for k, (c, amount) in enumerate(zip(limits, use, strict=True)):
            others = 0.0 if self.alone else self._others.undecided(now - c.window, k, limits)
            counts.append(max(0.0, min(amount, part * c.limit - self.used(now, k) - others)))
        self._others.use(now, tuple(counts), limits)
        self._others_known = (-math.inf, 0, (), False)  # what of theirs counts is less now
        self.use(now, tuple(counts))

    def others(self, now: float) -> tuple[Send, ...]:
        """What we know others to have sent, as far as it counts; in `split` they have their own parts."""
        known = now, self._view.traffic.revision, self.limits, self.alone
        if known != self._others_known:
            self._others_known = known
            self._others_sent = self._sent_by_others(now, now - self._memory)
        return self._others_sent

    def problem_limits(self, now: float) -> Limits:
        """Return the constraints of a problem, and what was sent that still counts."""
        usable = self.usable(now)
        windows = (1.0,) * len(usable) if self.turns else self.stretch.planned(usable)
        since = now - longest_window(stretched(usable, windows))
        others = self._sent_by_others(now, since)
        own = tuple(self.own.since(since))
        return Limits(
            usable,
            own,
            others,
            windows,
            alone=self.alone,
            turns=self.turns,
            agreed=self.coordination.team.agrees,
        )

    def _fits(self, now: float, k: int, message: float, amount: float, usable: tuple[Limit, ...]) -> bool:
        """Eq. 5; what is more than all that is usable has a stretched window for itself, or our turn."""
        limit, whole = self.limits[k], usable[k].limit
        part = self.coordination.meanwhile.confined
        if part < 1.0 and amount > _confined(self, now, k, part):
            return False
        turn = NOT_NEEDED
        if amount > whole or self.coordination.equal.by_clock:
            turn = self.coordination.turn(now, k, limit, amount)
        if self.coordination.equal.by_clock and turn.began > -math.inf:
            used = self.own.used(turn.began, k)
            return turn.began <= now and (used <= 0.0 or used + amount <= turn.slot * limit.limit)
        if turn.began == -math.inf and amount <= self._room(now, k, message, usable):
            return True
        if amount <= whole and turn.began == -math.inf:
            return False
        longer = limit.window * min(amount / whole, TUNING.stretched_windows)
        since = now - longer if turn.began == -math.inf else turn.began
        others = self._sent_by_others(now, since, words=False)
        return since <= now and self.own.used(since, k) <= 0.0 and all(use[k] <= 0.0 for t, use in others if t >= since)

    def _room(self, now: float, k: int, message: float, usable: tuple[Limit, ...], longer: float = 0.0) -> float:
        """Return what is left for a message in the window that ends now and began `longer` ago than it does [s].

        A little is left to small ones: beside a robot that claimed ten limits two sent 11 % of their odometry without
        that.
        """
        limit, certain, alone = usable[k], _certain(self._view, self.coordination), self.alone
        if self.turns:
            return limit.limit - self.own.used(now - limit.window - longer, k)
        room = self.stretch.room(now, k, usable, message, longer=longer, alone=alone)
        if not alone and self.limits[k].shared and message <= TUNING.certain_message * certain * limit.limit:
            room = max(room, certain * limit.limit - self.own.used(now - limit.window - longer, k))
        return room

    def _sent_by_others(self, now: float, since: float, *, words: bool = True) -> tuple[Send, ...]:
        """Return what others sent since then; with the `words` that exceeded the allowance, or without."""
        if self.alone:
            return ()
        return self._others.sends(now, since, self.usable(now), self.own.leave_after, words=words)


def in_turn(budget: Budget, now: float, use: tuple[float, ...]) -> bool:
    """Whether a message goes by turns of the clock, and needs no search to go in ours.

    In a large team only where our part would do for it: else 3.3 % of the windows of thirty robots were over the limit,
    and 0.9 are.
    """
    if not budget.by_turn(now, use):
        return False
    return not budget.coordination.team.large or all(amount <= budget.whole(now, k) for k, amount in enumerate(use))


def using(budget: Budget, now: float) -> float:
    """Return what part our own sends of the windows that end now take of what we may use of shared constraints."""
    shared = (k for k, limit in enumerate(budget.limits) if limit.shared)
    return max((budget.used(now, k) / budget.whole(now, k) for k in shared), default=0.0)


def sustained(budget: Budget, now: float) -> tuple[float, ...]:
    """Return what may be used of each limit in a second from now on [units/s].

    In a long window that is no more than what is left some parts of it ahead: who sent much at first slows down in
    time.
    """
    rates = []
    usable = budget.usable(now)
    for k, limit in enumerate(usable):
        rate = limit.limit / limit.window
        if limit.window > MARKET.long_window:
            for ahead in (part * limit.window for part in MARKET.long_ahead):
                counting = budget.stretch.used(now + ahead - limit.window, k, usable, 1.0, alone=budget.alone)
                rate = min(rate, max(0.0, limit.limit - counting) / ahead)
        rates.append(rate)
    return tuple(rates)


def grew(budget: Budget, limits: tuple[Limit, ...], now: float, ahead: float = 0.0) -> float:
    """Return when a send that changes plans leaves a window last, up to so far `ahead` [s]; −∞ where none does."""
    longest = longest_window(limit for limit in limits if limit.shared)
    last: dict[tuple[float, ...], float] = {}
    for t, use in (*budget.own, *budget.others(now)):
        if t + longest <= now + ahead:
            last[use] = max(t + longest, last.get(use, -math.inf))
    return max((left for use, left in last.items() if changes_plans(use, budget.limits)), default=-math.inf)


def _next_turn(budget: Budget, coordination: Coordination, now: float, use: tuple[float, ...]) -> float:
    """Return when our next turn by the clock begins with a message [s]; −∞ where it needs none."""
    turns = [coordination.turn(now, k, limit, use[k]) for k, limit in enumerate(budget.limits)]
    return max([turn.next + MARKET.closed for turn in turns if turn.began > -math.inf], default=-math.inf)


def _certain(view: SharedView, coordination: Coordination) -> float:
    """Return the part that we have for small samples whatever others say; none where nobody else sends, or has lately.

    What a robot says to have sent counts from its first word on, and after it left: alarms were dropped then.
    """
    team = coordination.team
    return TUNING.certain_part / team.robots if team.rivals or view.traffic.sends else 0.0


def _confined(budget: Budget, now: float, k: int, part: float) -> float:
    """Return what is left of a part that all have just agreed on: who keeps to its own already counts on that."""
    limit = budget.limits[k]
    return limit.limit * part - budget.used(now, k) if limit.shared else math.inf


def _part(before: Limit, limit: Limit) -> float:
    """Return which part of what was sent under the limit before counts under another one: as of its room and rate."""
    if before.measure == limit.measure:  # it follows the channel, or leaves the digests of more robots their part
        return limit.limit / before.limit if limit.least < 1.0 else 1.0
    part = limit.limit / before.limit
    return min(1.0, part, part * before.window / limit.window)


def _identity(limit: Limit) -> tuple[str, str]:
    """What makes a constraint the same one under new specs: amounts of another kind are in another unit."""
    return limit.name, limit.measure.kind
