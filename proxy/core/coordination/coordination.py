"""How robots keep a limit together: who counts what of whom, and which part of every shared limit is ours.

`announce`: each robot plans for all with what it knows and acts on its own samples only; what it sends the others hear
from the air, or from the digest that follows. That holds while news take less than about a quarter of the window, and
while the digests fit into their allowance.

`split`: each robot has a part of every limit (`proxy.core.split`), and needs no news of the others. It is what an
operator configures who needs the limit kept at any latency, and what a team changes over to where news take too long or
announcements cost too much. Each robot says which it finds due, in its digests; the team splits while any of them says
so. In between, who still plans for all counts only what it knows the others to have sent, not their parts.

A large team would take a minute to agree on parts. There each robot has an equal one, of which nobody has to tell, and
may use more of it than it is (`overbooking.py`); where an operator asked for `split`, an equal part and no more. Fifty
robots with streams of 0.1 to 4 kB reached 94 % of a central decider so, in unicast as in broadcast, with no window over
the limit; agreeing on parts they reached 41, and where all overheard all 94 with 60 % of the windows over.
"""

import math
from collections import deque
from collections.abc import Callable, Collection, Sequence

from proxy.core.coordination.demands import bid
from proxy.core.coordination.overbooking import Overbooking
from proxy.core.model.limits import Limit, fingerprint, shortest_window
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import Digest, tag
from proxy.core.protocol.parts import Told
from proxy.core.split.split import Split
from proxy.core.view.view import SharedView

LATE = 0.25
"""News are late where they take this part of the shortest window: at a fifth of it five robots with samples of random
sizes reached 95 % of a central decider in `announce`, with 6 to 9 % of windows over, and 74 to 91 in `split`..."""
AFFORDABLE = 0.8
"""... and announcements cost too much where they take this part of the allowance;"""
STILL = 0.8
"""and both still when it is a little less: so many times that."""
LASTING = 2.0
"""A small team changes over when they have done so for so long [s]: what few samples say of sizes and rates varies."""
IN_A_ROW = 3
"""So many digests that were long on their way, one after the other, say that a queue makes news late: four robots that
began at once filled 2.8 times the limit for ever without it, and for two seconds with it."""
FORMING = 5.0
"""A team that begins has so long to agree on parts before all that it has to tell goes on [s]."""
FEW = 16
"""Of more robots than these some have something to send, though nobody may have heard of it yet."""
LARGE = 25
"""So many other robots are too many to agree on parts: it takes them half a minute, fifty a whole one."""
ALL = 0.95
"""Who has so much of a limit may take it all for a message that is larger."""
PACE = 0.25
"""Both are looked at this often [s]."""


class Coordination:
    """Which coordination is in force here, and our part of the shared limits, which come first in all tuples."""

    def __init__(self, now: float, settings: CoreSettings, view: SharedView) -> None:
        self._settings = settings
        self._always = settings.coordination == "split"
        self._view = view
        self._settled_at = now + settings.settle
        self._due = now
        self._voting: set[str] = set()
        """Tags of the others that find that the team has to split."""
        self._took: deque[float] = deque(maxlen=IN_A_ROW)
        """What the last digests took to us [s]."""
        self._members: frozenset[str] = frozenset()
        self._kind: tuple[tuple[float, ...], int] = (), 0
        self._split: Split | None = None
        self._overbooking = Overbooking()
        self._told: Told | None = None
        self._forms_until, self._did_split = now + FORMING, self._always
        self._formed_at = math.inf
        """Since when parts are agreed on that take in what all ask for [s]."""
        self._established = self._always
        """Whether that was so for a window; until then all have equal parts, or what tables give them."""
        self.finds_due = self._always
        """Whether we find that the team has to split."""
        self._dear_since = math.inf
        """Since when announcements cost too much [s]."""
        self.rivals = False
        """Whether several robots have something to send."""
        self.tells = False
        """Whether others have to hear of what we send, as far as we know."""
        self.mute_until = now
        """When the allowance has room for announcements [s]."""

    @property
    def splits(self) -> bool:
        """Whether each robot has a part of every limit."""
        return self._always or (self.rivals and (self.finds_due or bool(self._voting)))

    @property
    def large(self) -> bool:
        """Whether the team is too large to agree on parts, or to tell all of all."""
        return len(self._members) >= LARGE

    @property
    def quiet(self) -> bool:
        """Whether a large team has equal parts: nobody plans with what the others tell."""
        return self.splits and self.large

    @property
    def _robots(self) -> int:
        return len(self._members) + 1

    @property
    def _overbooks(self) -> bool:
        """Whether we may use more than our part of a window, as seldom all use theirs at one moment."""
        return self._split is not None and self.quiet and not self._always

    @property
    def _agrees(self) -> Split | None:
        """The parts that the team agrees on."""
        return self._split if self.splits and not self._overbooks else None

    def part(self, now: float, k: int) -> float:
        """Return what part of shared limit number `k` we may use within the window that ends now.

        Where a team changes over each robot takes an equal part, or what the table gives it that it tells the others,
        until it has had what all have agreed on for a window.
        """
        if self._overbooks:
            return self._overbooking.factor / self._robots
        if (split := self._agrees) is None:
            return 1.0 - self._settings.margin if self.rivals else 1.0
        ours = split.part(now, k)
        if self._established:
            return ours
        equal = (1.0 - self._settings.floor) / self._robots
        return max(ours, min(equal, split.least))

    def grows_at(self, now: float) -> float:
        """When our part grows if nothing is heard, as what others sent in a slot of ours has left it [s]; else ∞."""
        return math.inf if self._agrees is None else self._agrees.grows_at(now)

    def whole_turn(self, now: float, k: int) -> bool:
        """Whether a message may go now that is larger than all we may use.

        Nobody else may send then; or, in a large team, we have not sent for as many windows as it has parts.
        """
        return self._agrees is None or self.part(now, k) >= ALL

    def sent(self, now: float, uses: Sequence[float]) -> None:
        """A message was sent that uses such parts of the shared limits."""
        if self._split is not None:
            self._split.sent(now, uses)

    def heard(self, now: float, digest: Digest) -> None:
        """A digest of another robot came, newer than all before."""
        if digest.tag not in self._members:
            return
        self._took.append(now - self._view.peers[digest.tag].offset.ours(digest.sent))
        if digest.brief:
            return
        voting, told = digest.splits, digest.split
        (self._voting.add if voting else self._voting.discard)(digest.tag)
        if told is not None and self._split is not None:
            self._split.heard(now, digest.tag, told, self._view.peers[digest.tag].offset.ours(digest.sent))

    def set_members(self, now: float, members: Collection[str]) -> None:
        """These robots take part, and we."""
        self._members, self._due = frozenset(members), now
        self._voting &= self._members
        self._introduce(now)

    def set_limits(self, now: float, limits: Sequence[Limit]) -> None:
        """The constraints are now these."""
        windows = tuple(limit.window for limit in limits if limit.shared)
        kind = windows, fingerprint(self._view.specs)
        if kind == self._kind:
            return
        version = 0 if self._split is None else self._split.telling(now).version + 1
        self._kind, self._split = kind, None
        if windows:
            self._split = Split(
                tag(self._settings.zid),
                now,
                windows,
                floor=self._settings.floor,
                settled_at=max(now, self._settled_at),
                kind=b"%d" % kind[1],
                version=version,
            )
            self._introduce(now)

    def look(
        self,
        now: float,
        limits: Sequence[Limit],
        waiting: float,
        announcing: Callable[[float], float],
        using: Callable[[float], float],
    ) -> bool:
        """Look whether the team has to split, and what to ask for; return whether there is something to tell.

        News of others are `waiting` so long on a channel that is full [s]; `announcing` tells what part of the
        allowance announcements take, `using` what part we use of what we may.
        """
        due = now >= self._due
        if due:
            self._due = now + PACE
            self._judge(now, limits, waiting, announcing)
            if self._overbooks:
                self._overbooking.look(now, using(now), self._robots)
        if (split := self._agrees) is not None and not self._did_split:
            split.begin(now)
            due, self._forms_until = True, now + FORMING
        self._did_split = split is not None
        if split is not None:
            if due:
                split.bid(now, bid(self._view, now, limits))
            split.look(now, max(self._longest_way(), waiting))
            self._formed_at = min(self._formed_at, now) if split.formed else math.inf
            self._established |= now >= self._formed_at + max(self._kind[0])
        return self._news(now)

    def telling(self, now: float) -> Told | None:
        """Return what a digest says of parts; None where all plan for all."""
        return None if self._agrees is None or self._agrees.silent else self._agrees.telling(now)

    def told(self, digest: Digest) -> None:
        """A digest of ours goes out."""
        if digest.brief:
            return
        self._told = digest.split
        if digest.split is not None and self._split is not None:
            self._split.told(digest.sent, digest.split)

    @property
    def formed(self) -> bool:
        """Whether parts were agreed on that take in what all ask for."""
        return self._split is not None and self._split.formed

    @property
    def passes_on(self) -> bool:
        """Whether a robot waits for a slot that we pass on: for us alone."""
        return self._agrees is not None and self._agrees.passes_on

    def begins(self, now: float) -> bool:
        """Whether a team that splits from the beginning has just begun."""
        return self._always and now < self._forms_until

    def forming(self, now: float) -> bool:
        """Whether the team begins so, or agrees on parts for the first time: all else that is to tell has time."""
        return self._agrees is not None and (self._always or not self.formed) and now < self._forms_until

    @property
    def settled(self) -> bool:
        """Whether nobody waits to hear of parts."""
        return self._agrees is None or self._agrees.settled

    def due_at(self, now: float) -> float:
        """When this changes by time alone [s]."""
        if (split := self._agrees) is None:
            return self._due if self._view.peers else math.inf
        return min(self._due, split.due_at(now))

    def _introduce(self, now: float) -> None:
        """Tell the split who takes part."""
        if self._split is not None:
            self._split.set_members(now, self._members)
            self._split.set_quiet(now, quiet=self.large)

    def _judge(self, now: float, limits: Sequence[Limit], waiting: float, announcing: Callable[[float], float]) -> None:
        window, still = shortest_window(limits), STILL if self.finds_due else 1.0
        sending = {stream.robot for stream in self._view.competition.all(now)} | self._unheard()
        # Where each has its part, what a robot sends is told seldom, and its bid says that it does.
        asked = self._agrees is not None and self._agrees.rivals
        self.rivals = asked or len(sending) > 1 or len(self._view.peers) > FEW
        # Who has just been met may send before it can say so.
        self.tells = self.rivals or bool(self._view.met_lately(now))
        if not self.rivals or math.isinf(window):
            self.finds_due = self._always
        else:
            # Of very many that send at once each hears too late of the others.
            many = len(sending) >= still * LARGE
            # Late news harm nobody who has nothing to decide: an operator hears digests behind the frames it gets.
            # Where limits follow the channel it is a queue that makes news late, and these dissolve it.
            decides = self._view.settings.robot in sending and all(limit.least >= 1.0 for limit in limits)
            late = decides and max(self._longest_way(), waiting) >= still * LATE * window
            dear = announcing(now) > still * AFFORDABLE
            self._dear_since = min(self._dear_since, now) if dear else math.inf
            lasting = 0.0 if len(self._view.peers) > FEW else LASTING
            self.finds_due = self._always or late or many or now >= self._dear_since + lasting

    def _unheard(self) -> set[str]:
        """Return the robots that have streams, as their states say, of which no digest has told anything yet."""
        known = {stream.robot for stream in self._view.streams()}
        new = (peer for peer in self._view.peers.values() if peer.robot not in known and not peer.plain)
        return {peer.robot for peer in new if any(self._view.specs.planned(key) for key in peer.told)}

    def _news(self, now: float) -> bool:
        """Whether others wait to hear what a digest would say of parts, or that there are none any more."""
        return self._told is not None if self._agrees is None else self._agrees.has_news(now)

    def _longest_way(self) -> float:
        """What digests take from or to any robot at most, and took to us lately [s].

        Not what samples take: frames wait for each other on a channel that is full, and news go by. What others hear
        late they say themselves.
        """
        return max(self._view.longest_way, min(self._took, default=0.0))
