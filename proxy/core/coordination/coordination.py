"""How robots keep a limit together: who counts what of whom, and which part of every shared limit is ours.

`announce`: each robot plans for all with what it knows and acts on its own samples only. That holds while news take
less than about a quarter of the window, and while digests fit into their allowance.

`split`: each robot has a part of every limit (`proxy.core.split`), and needs no news of the others. An operator
configures it, or a team changes over where news take too long, announcements cost too much, or in unicast large samples
of all come seldom (`team.py`): then each may overbook its part (`overbooking.py`). Where no agreement comes about all
plan for all and try again later (`patience.py`).

A large team would take a minute to agree: there each robot has an equal part, which it may overbook, and larger
messages go by turns of the clock (`equal_parts.py`); so it is in smaller teams of small messages where announcements
cost too much. Fifty robots with streams of 0.1 to 4 kB reach 96 % of a central decider so, and 41 agreeing.
"""

import math
from collections.abc import Callable, Collection, Sequence

from proxy.core.coordination.demands import bid, usual
from proxy.core.coordination.equal_parts import NOT_NEEDED, NOT_NOW, EqualParts, Turn
from proxy.core.coordination.formation import Formation, Meanwhile
from proxy.core.coordination.hollow import Hollow
from proxy.core.coordination.overbooking import Overbooking
from proxy.core.coordination.team import Asking, Team
from proxy.core.coordination.tuning import TUNING
from proxy.core.model.limits import Limit, fingerprint
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.bid import UNIT
from proxy.core.protocol.messages import Digest, State, tag
from proxy.core.protocol.split_report import SplitReport
from proxy.core.split.exchange import Exchange
from proxy.core.split.split import Split
from proxy.core.view.view import SharedView


class Coordination:
    """Our part of the shared limits, which come first in all tuples."""

    def __init__(self, now: float, settings: CoreSettings, view: SharedView) -> None:
        self._settings, self._view = settings, view
        self.team = Team(view, now)
        self._settled_at = now + settings.settle
        self.looks_at = now
        """When it is looked again whether the team has to split, and what to ask for [s]."""
        self._kind: tuple[tuple[float, ...], int] = (), 0
        """What the split is of: the windows of the shared limits [s], and the fingerprint of the specs."""
        self._split: Split | None = None
        self.equal, self._overbooking = EqualParts(now), Overbooking(TUNING.agreed_deviations)
        self.hollow = Hollow()
        self.keeps = 0.0
        """The part that we keep to, where claims of others are hollow: nothing that they send counts against it."""
        self.told: SplitReport | None = None
        self.formation = Formation(now, strict=self.team.strict)
        self.meanwhile = Meanwhile()

    @property
    def _all_equal(self) -> bool:
        """Whether all have equal parts that nobody agrees on; we may use more than ours where not all use theirs."""
        return self._split is not None and self.team.quiet and not self.team.strict

    @property
    def binds(self) -> bool:
        """Whether each robot keeps to its part of every limit, and counts nothing that others send."""
        return self.team.splits and not self.meanwhile.plans

    @property
    def split_in_force(self) -> Split | None:
        """The parts that the team agrees on."""
        return None if self._split is None or self.keeps or self._all_equal or not self.team.splits else self._split

    def part(self, now: float, k: int) -> float:
        """Return what part of shared limit number `k` we may use within the window that ends now.

        Where a team changes over, an equal part or what its table gives us until all have agreed for a window.
        """
        split = self._split
        if not self.keeps and (split is None or not self.binds):
            margin = max(self._settings.margin, TUNING.varied_margin if self.team.varied else 0.0)
            return 1.0 - margin if self.team.rivals else 1.0
        if self.keeps or split is None:
            return self.keeps
        if self._all_equal:
            return self.equal.part(self.team)
        ours = split.own_part.of(now, k)
        if self.formation.established:
            return min(1.0, ours * self._overbooking.factor)
        equal = (1.0 - self._settings.floor) / self.team.robots
        return max(ours, min(equal, split.agreement.exclusive / UNIT))

    def grows_at(self, now: float) -> float:
        """When our part grows if nothing is heard, as what others sent in a slot of ours has left it [s]; else ∞."""
        return math.inf if self.split_in_force is None else self.split_in_force.own_part.grows_at(now)

    def turn(self, now: float, k: int, limit: Limit, amount: float) -> Turn:
        """Return our turn with a message too large for our part; none is needed where nobody else may send."""
        if not limit.shared:
            return NOT_NEEDED
        if self.equal.by_clock:
            return self.equal.turn(now, k, amount / limit.limit)
        split = self.split_in_force  # who overbooks its part has no more of the limit to itself
        alone = split is None or split.own_part.of(now, k) >= TUNING.whole_part
        return NOT_NEEDED if alone else NOT_NOW

    def sent(self, now: float, uses: Sequence[float]) -> None:
        """A message was sent that uses such parts of the shared limits.

        Before parts are agreed on it is no larger than it may be: else five of ten robots with equal messages sent
        nothing for minutes, as their slots stayed theirs for 76 windows (62 % of a central decider, 79 to 90 now).
        """
        if self._split is None:
            return
        self.equal.sent(now, uses)
        windows, least = 1.0, 1.0 / UNIT
        if max(uses, default=0.0) > least:  # not for each of hundreds of small samples a second
            windows = max([1.0, *(use / max(self.part(now, k), least) for k, use in enumerate(uses))])
        self._split.sent(now, uses, windows)

    def heard(self, now: float, message: Digest | State) -> None:
        """A digest of another robot came, newer than all before, or a state, which may be of any time."""
        name = message.tag if isinstance(message, Digest) else tag(message.zid)
        if name not in self.team.members:
            return
        sent = -math.inf
        if isinstance(message, Digest):
            sent = self._view.peers[name].offset.ours(message.sent)
            self.team.heard(message, now - sent)
        elif message.since and message.split is not None:
            self.team.heard_vote(name, splits=message.splits)
        if self._split is not None and message.split is not None:
            self._split.heard(now, name, message.split, sent)

    def set_members(self, now: float, members: Collection[str]) -> None:
        """These robots take part, and we."""
        self.team.set_members(members)
        self.looks_at = now
        _introduce(now, self._split, self.team)

    def set_limits(self, now: float, limits: Sequence[Limit]) -> None:
        """The constraints are now these."""
        windows = tuple(limit.window for limit in limits if limit.shared)
        kind = windows, fingerprint(self._view.specs)
        if kind == self._kind:
            return
        version = 0 if self._split is None else self._split.agreement.bid[0] + 1
        self._kind, self._split = kind, None
        self.hollow.begin_anew()
        self.formation, self.looks_at = Formation(now, strict=self.team.strict), now
        self.equal.set_windows(now, windows)
        if windows:
            self._split = Split(
                tag(self._settings.zid),
                now,
                windows,
                floor=self._settings.floor,
                settled_at=max(now, self._settled_at),
                kind=b"%d" % kind[1],
                version=version,
                twice=self._settings.digests_on_air,
            )
            _introduce(now, self._split, self.team)

    def advance(
        self,
        now: float,
        limits: tuple[Limit, ...],
        waiting: float,
        announcing: Callable[[Sequence[Asking]], float],
        using: Callable[[float], float],
        *,
        passes_at: Callable[[float], float],
    ) -> bool:
        """See whether the team has to split, and what to ask for; return whether there is something to announce.

        News of others are `waiting` so long [s]; announcements take a part of the allowance by `announcing`, our sends
        one of what we may by `using`; by `passes_at` it could be told that a slot of ours is passed on.
        """
        if not len(self._view.streams):
            self.formation.wait(now)
        due = now >= self.looks_at or (self.team.undecided and not self.team.rhythms_known)
        if due:
            self._look(now, limits, waiting, announcing, using)
        if self.formation.established or self._split is None:
            self.meanwhile.over()
        else:
            self.meanwhile.look(self.team, self._split.agreement, limits, waiting)
        split = self.split_in_force
        entered = self.formation.enters(now, splits=split is not None)
        if split is None:
            return self.told is not None
        if entered:
            split.exchange.begin()
        if not self.team.rhythms_known:
            return False
        # Who asks anew and cannot tell so keeps the others from doing so, and from agreeing, until it can.
        if (due or entered) and (not split.agreement.formed or passes_at(now) <= now):
            takes = self._view.words_take(self.team.robots)
            split.bid(now, bid(self._view, now, limits), usual=usual(self._view, now, limits), takes=takes)
        split.advance(now, self.team.news_take(waiting), passes_at(now))
        self.formation.look(now, formed=split.agreement.formed, window=max(self._kind[0]))
        return split.exchange.has_news(now)

    def _look(
        self,
        now: float,
        limits: tuple[Limit, ...],
        waiting: float,
        announcing: Callable[[Sequence[Asking]], float],
        using: Callable[[float], float],
    ) -> None:
        """See whether the team has to split, and what each may use beyond its part, or where nobody agrees on any."""
        self.looks_at = now + TUNING.interval
        split = self.split_in_force
        asked = split is not None and split.agreement.rivals
        self.team.wait(now, waiting, None if split is None else split.agreement, max(self._kind[0], default=math.inf))
        self.keeps = self.hollow.keeps(now, self._view, limits, self.team)
        self.team.judge(now, limits, waiting, announcing, asked=asked, heeded=not self.keeps)
        self._view.audiences.take_alike(alike=self.team.agrees)
        if self._split is not None:
            self._split.set_quiet(now, quiet=self.team.large or self.team.quiet)
        if self._all_equal:
            self.equal.look(now, self._view, limits, self.team, using)
        else:
            self.equal.rest()
        # Parts hold a limit in every window by configuration, or where news are late and words not dear.
        split = self.split_in_force  # the team may have changed over
        overbooks = self.formation.established and self.team.tight and not self.team.strict
        log = split.agreement.log if split is not None and overbooks else None
        self._overbooking.look(now, log, using, max(self._kind[0], default=0.0))

    def announcement(self, now: float) -> SplitReport | None:
        """Return what a digest says of parts; None where all plan for all, or we cannot tell yet what we need."""
        if (split := self.split_in_force) is None or split.agreement.silent or not self.team.rhythms_known:
            return None
        return split.announcement(now)

    def announced(self, now: float, report: SplitReport | None) -> None:
        """This goes out in a digest of ours, or in a state."""
        self.told = report
        if report is not None and self._split is not None:
            self._split.announced(now, report)

    @property
    def exchange(self) -> Exchange | None:
        """What we announce of parts, where the team agrees on them."""
        return None if self.split_in_force is None else self.split_in_force.exchange

    def begins(self, now: float) -> bool:
        """Whether a team that splits from the beginning has just begun, or may."""
        return self.formation.begins(now, self.team)

    def forming(self, now: float) -> bool:
        """Whether the team begins so, or agrees on parts for the first time: all other announcements have time."""
        split = self.split_in_force
        return split is not None and self.formation.lasts(now) and (self.begins(now) or not split.agreement.formed)

    @property
    def settled(self) -> bool:
        """Whether nobody waits to hear of parts."""
        return self.split_in_force is None or self.split_in_force.agreement.settled

    def due_at(self, now: float) -> float:
        """When this changes by time alone [s]: where all plan for all, only what happens is looked at."""
        if (split := self.split_in_force) is None:
            return self.looks_at if self._all_equal else math.inf
        return min(self.looks_at, split.due_at(now))


def _introduce(now: float, split: Split | None, team: Team) -> None:
    if split is not None:
        split.set_members(now, team.members)
        split.set_quiet(now, quiet=team.large)
