"""The layout: as leader of the shares, what others should send is planned, and lent to them ahead of time.

It is the plan that one decider for all would make: the joint problem of all robots' expected messages, in which what is
lent already is sent. Of the messages that it sends, those that come before we can speak again are promised: their
robots are lent what these take, around the time at which they are expected. The later ones are planned anew.
"""

import math
import operator
from collections.abc import Iterable
from dataclasses import dataclass

from planner import Plan
from proxy.core.asks import ANSWERED, SPREADS, asks
from proxy.core.cadence import Place
from proxy.core.commands import Decide
from proxy.core.gate import Gate
from proxy.core.inbox import Waiting
from proxy.core.lateness import LATE
from proxy.core.limits import Promise, shortest_window, use_of
from proxy.core.peer import Peer
from proxy.core.plenty import Plenty
from proxy.core.shares import Lent, Shares
from proxy.core.slots import LASTS, LONGEST, MARGIN, RENEWED, STANDING, Demand, allot, demands, lengthened_by
from proxy.core.stream import Stream
from proxy.core.view import SharedView
from proxy.core.window import Expected, Outlook, WindowBuilder
from proxy.core.wire import tag

PACE = 0.1
"""It is planned this often [s]..."""
HURRY = 1e-4
"""... or when there is news, but not sooner than so long for every robot after the last time [s]."""
LEAST_SLACK = 0.015
"""A message may be sent so much earlier or later than expected, at least [s]."""
LARGER = 1.5
"""A slot may be larger than what it is for by this factor."""
SLOW = 0.05
"""Where planning takes this part of the shortest window, what it says comes too late: slots are lent..."""
FORGETTING = 0.98
"""... and while they are, each time it is forgotten by this factor how long planning took."""
IRREGULAR = 0.05
"""Where news take long slots are lent when messages come earlier or later by this part of the shortest window..."""
KEEPS = 0.8
"""... and still when it is a little less: so many times that."""
LEARNING = 0.2
"""So much counts the last message of a stream for how far off they are, and the last plan for how long it took."""
REMEMBERED = 16
"""So many promises of a stream are looked back on."""
DOUBT = 3.0
"""What a robot does not tell of having sent so much later, it did not send [s]."""


class Layout:
    """Plans for others what we lend to them. `lent` counts the grants."""

    def __init__(self, view: SharedView, shares: Shares, gate: Gate, windows: WindowBuilder) -> None:
        self._view = view
        self._shares = shares
        self._gate = gate
        self._windows = windows
        self._plenty = Plenty(view, shares)
        self._promised: dict[tuple[str, str], list[Promise]] = {}
        self._off: dict[tuple[str, str], _Off] = {}
        self._slots: dict[Place, list[Lent]] = {}
        self._asked_at = -math.inf
        self._took = 0.0
        self._hurried = False
        self._ticket: int | None = None
        self._outlook = Outlook(None, {}, ())
        self.lent = 0

    def ask(self, now: float, ticket: int, waiting: Iterable[Waiting]) -> list[Decide]:
        """Have it planned what others should send, if it is time to."""
        if not self._lends:
            self._gate.promised, self._ticket, self._gate.standing = None, None, False
            self._promised.clear()
            self._slots.clear()
            return []
        if self.pending or now < self._asked_at + self._pace or not self._shares.confirmed(now):
            return []
        self._asked_at, self._hurried = now, False
        self._forget(now)
        plenty = self._plenty.there(now, [limit for limit in self._gate.limits if limit.shared])
        self._gate.standing = plenty or self._vague(now) or self._irregular(now)
        if self._gate.standing:
            self._gate.promised, self._ticket = None, None
            self._promised.clear()
            self._took *= FORGETTING
            if plenty:
                self.lent += self._plenty.lend(now)
            else:
                self._stand(now)
            return []
        self._outlook = self._windows.ahead(now, waiting, self._gate.problem_limits(now))
        if self._outlook.problem is None or not self._outlook.ahead:
            self._promise_all(now, self._outlook.demanded, now + 2.0 * PACE)
            return []
        self._ticket = ticket
        return [Decide(ticket, self._outlook.problem, ticket, self._view.settings.iterations, now, ahead=True)]

    @property
    def due_at(self) -> float:
        """When it is time to plan again [s]; a plan that is being made comes to its end first."""
        return self._asked_at + self._pace if self._lends and not self.pending else math.inf

    @property
    def _lends(self) -> bool:
        """Whether there is anybody to lend to, and anything."""
        shares = self._shares
        return shares.leads and len(shares.members) > 1 and any(limit.shared for limit in self._gate.limits)

    @property
    def pending(self) -> bool:
        """Whether a plan is being made."""
        return self._ticket is not None

    def answered(self, ticket: int) -> bool:
        """Whether this is the answer that we wait for."""
        return self._ticket is not None and ticket == self._ticket

    def lend(self, now: float, plan: Plan | None, until: float) -> bool:
        """Lend for what the plan has others send until then; whether anything was lent."""
        self._ticket = None
        self._took += LEARNING * (now - self._asked_at - self._took)
        if plan is None:
            return False
        ahead = self._outlook.ahead
        chosen = [*self._outlook.demanded, *(ahead[place] for place in plan.sends if place in ahead)]
        return self._promise_all(now, chosen, until + self._took)

    def _promise_all(self, now: float, chosen: Iterable[Expected], until: float) -> bool:
        early = [(self._shares.reserved(self._use_of(e)), e) for e in chosen]
        early.sort(key=lambda entry: -entry[0])  # what needs the channel for itself comes before what would disturb it
        due = [e for first, e in early if e.message.t_gen - first <= (now if self._asks(e.stream) else until)]
        return sum(self._promise(now, expected) for expected in due) > 0

    def _use_of(self, expected: Expected) -> tuple[float, ...]:
        """What is lent for a message, of the limits that robots share."""
        shared = tuple(limit for limit in self._gate.limits if limit.shared)
        return tuple(MARGIN * amount for amount in use_of(expected.message.size, expected.copies, shared))

    def unused(self, robot: str, lent: Iterable[Lent]) -> None:
        """A robot did not use this: what it was for may be sent after all, if we lend for it again."""
        ends = {each.ends for each in lent}
        for place, promises in self._promised.items():
            if place[0] == robot and ends:
                promises[:] = [promise for promise in promises if promise.ends not in ends]

    def hurry(self) -> None:
        """There is news: plan anew at once, or as soon as a large team leaves time for it."""
        self._hurried = True

    @property
    def _pace(self) -> float:
        return min(PACE, HURRY * len(self._shares.members)) if self._hurried else PACE

    def _vague(self, now: float) -> bool:
        """Whether robots may be so wrong about our clock, or we so slow, that slots are better than single grants."""
        window = shortest_window(self._gate.limits)
        return max(self._view.doubts(now), default=0.0) > STANDING * window or self._took > SLOW * window

    def _far(self) -> bool:
        """Whether news take long even when nothing waits anywhere."""
        return self._view.longest_way >= LATE * shortest_window(self._gate.limits)

    def _irregular(self, now: float) -> bool:
        """Whether what is lent ahead of time would have to leave much time for when messages come."""
        if not self._far():
            return False
        streams = self._view.competition.all(now)
        weights = [max(stream.newest.scale, 1e-9) for stream in streams]
        mean = sum(map(operator.mul, weights, map(self._spread, streams))) / max(sum(weights), 1e-9)
        return bool(
            SPREADS * mean > IRREGULAR * shortest_window(self._gate.limits) * (KEEPS if self._gate.standing else 1.0)
        )

    def _stand(self, now: float) -> None:
        """Lend slots, and lengthen those that are to stay."""
        shares, own = self._shares, self._view.settings.robot
        shared = tuple(limit for limit in self._gate.limits if limit.shared)
        tags = {peer.robot: name for name, peer in self._view.peers.items() if peer.offset.known}
        wanted = demands(now, self._view, shared, self._gate.cadences)
        alive = set(shares.lent(now))
        self._slots = {
            place: left for place, slots in self._slots.items() if (left := [s for s in slots if s in alive])
        }
        held = {place: len(slots) for place, slots in self._slots.items()}
        counts = allot(wanted, [shares.whole(k) for k in range(len(shared))], held)
        for demand in wanted:
            if demand.known and demand.place[0] != own and demand.place[0] in tags:
                self._fill(now, demand, counts[demand.place], tags[demand.place[0]])

    def _fill(self, now: float, demand: Demand, count: int, peer: str) -> None:
        """Let a stream of `peer` have so many slots, and for those that last too short more time."""
        slots, offset = self._slots.setdefault(demand.place, []), self._view.peers[peer].offset
        heard = lengthened_by(now, offset)
        fitting = [s for s in slots if _fits(demand.use, s.amounts) and s.ends - s.begins < LONGEST]
        for slot in fitting[:count]:
            if slot.ends < heard and (longer := self._shares.lengthen(now, slot, heard + RENEWED)) is not None:
                slots[slots.index(slot)] = longer
                self.lent += 1
        for _ in range(count - len(fitting)):
            lent = self._shares.lend(now, peer, now, heard + RENEWED, demand.use, lasting=LASTS)
            if lent is None:
                break
            slots.append(lent)
            self.lent += 1

    def _asks(self, stream: Stream) -> bool:
        peer = self._view.peer_called(stream.robot)
        return peer is not None and asks(self._view, stream, peer, self._gate.limits)

    def _promise(self, now: float, expected: Expected) -> bool:
        stream, message = expected.stream, expected.message
        peer = self._view.peer_called(stream.robot)
        if peer is None or not peer.offset.known:
            return False
        use = self._use_of(expected)
        slack, center = self._slack(now, stream, peer), message.t_gen
        if center <= now:
            center, slack = now, 2.0 * peer.offset.latency + ANSWERED
        lent = self._shares.lend(now, tag(peer.zid), center - slack, center + slack, use)
        if lent is None:
            return False
        promise = Promise(message.t_gen, lent.ends, message.size, message.scale, message.features)
        self._promised.setdefault((stream.robot, stream.key), []).append(promise)
        self._gate.promised = self._promised
        self.lent += 1
        return True

    def _slack(self, now: float, stream: Stream, peer: Peer) -> float:
        return LEAST_SLACK + SPREADS * self._spread(stream) + self._view.doubt(now, peer)

    def _spread(self, stream: Stream) -> float:
        """How far generation times deviate from what is expected, in standard deviations [s]."""
        off = self._off.get((stream.robot, stream.key))
        return max(stream.schedule.jitter, 0.0 if off is None else off.deviation)

    def _look_back(self, now: float) -> None:
        """How far off what was expected came, as far as we are told."""
        streams = [stream for place in self._promised if (stream := self._view.known(*place)) is not None]
        for stream in self._view.competition.all(now) if self._far() else streams:
            if stream.last is None:
                continue
            place = stream.robot, stream.key
            due = [promise.t_gen for promise in self._promised.get(place, ())]
            if (rhythm := stream.schedule.rhythm) is not None:
                due.append(rhythm.due(stream.generated))
            self._off.setdefault(place, _Off()).note(stream.newest.t_gen, due, 0.5 * stream.schedule.period)
        if len(self._off) > self._view.settings.streams:
            self._off = {place: off for place, off in self._off.items() if place in self._promised}

    def _forget(self, now: float) -> None:
        self._look_back(now)
        for place, promises in list(self._promised.items()):
            promises[:] = [p for p in promises[-REMEMBERED:] if p.ends >= now - DOUBT]
            if not promises:
                del self._promised[place]


@dataclass(slots=True)
class _Off:
    """By how much the messages of a stream came off when they were expected: mean of the squares [s²]."""

    square: float = 0.0
    looked_at: float = -math.inf

    @property
    def deviation(self) -> float:
        """In standard deviations [s]."""
        return math.sqrt(self.square)

    def note(self, t_gen: float, due: Iterable[float], most: float) -> None:
        """A message was generated then; one more than `most` off was not the one expected [s]."""
        if t_gen <= self.looked_at:
            return
        self.looked_at = t_gen
        off = min((abs(t_gen - t) for t in due), default=math.inf)
        if off < most:
            self.square += LEARNING * (off * off - self.square)


def _fits(use: tuple[float, ...], amounts: tuple[float, ...]) -> bool:
    """Whether a slot has room for a message and a margin, and for not much more."""
    return all(amount * MARGIN >= need >= amount / LARGER for need, amount in zip(use, amounts, strict=True))
