"""The layout: as leader of the shares, what others should send is planned, and lent to them ahead of time.

It is the plan that one decider for all would make: the joint problem of all robots' expected messages, in which what is
lent already is sent. Of the messages that it sends, those that come before we can speak again are promised: their
robots are lent what these take, around the time at which they are expected. The later ones are planned anew.
"""

import math
from collections.abc import Iterable

from planner import Plan
from proxy.core.asks import ANSWERED, SPREADS, asks
from proxy.core.commands import Decide
from proxy.core.gate import Gate
from proxy.core.inbox import Waiting
from proxy.core.limits import Promise, use_of
from proxy.core.shares import Shares
from proxy.core.stream import Stream
from proxy.core.view import SharedView
from proxy.core.window import Ahead, Expected, WindowBuilder

PACE = 0.1
"""It is planned this often [s]..."""
HURRY = 1e-4
"""... or when there is news, but not sooner than so long for every robot after the last time [s]."""
LEAST_SLACK = 0.015
"""A message may be sent so much earlier or later than expected, at least [s]."""
MARGIN = 1.01
"""Messages may be larger by so much than the last one of the stream."""
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
        self._promised: dict[tuple[str, str], list[Promise]] = {}
        self._asked_at = -math.inf
        self._hurried = False
        self._ticket: int | None = None
        self._ahead: Ahead = {}
        self.lent = 0

    def ask(self, now: float, ticket: int, waiting: Iterable[Waiting]) -> list[Decide]:
        """Have it planned what others should send, if it is time to."""
        if not self._shares.leads or len(self._shares.members) < 2 or not self._gate.limits:
            self._gate.promised, self._ticket = None, None
            self._promised.clear()
            return []
        if now < self._asked_at + self._pace or not self._shares.confirmed(now):
            return []
        self._asked_at, self._hurried = now, False
        self._forget(now)
        found = self._windows.ahead(now, waiting, self._gate.problem_limits(now))
        if found is None or not found[1]:
            return []
        problem, self._ahead = found
        self._ticket = ticket
        return [Decide(ticket, problem, ticket, self._view.settings.iterations)]

    @property
    def due_at(self) -> float:
        """When it is time to plan again [s]."""
        return self._asked_at + self._pace if self._shares.leads and len(self._shares.members) > 1 else math.inf

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
        if plan is None:
            return False
        chosen = [self._ahead[place] for place in plan.sends if place in self._ahead]
        due = [e for e in chosen if e.message.t_gen <= (now if self._asks(e.stream) else until)]
        return sum(self._promise(now, expected) for expected in due) > 0

    def hurry(self) -> None:
        """There is news: plan anew at once, or as soon as a large team leaves time for it."""
        self._hurried = True

    @property
    def _pace(self) -> float:
        return min(PACE, HURRY * len(self._shares.members)) if self._hurried else PACE

    def _asks(self, stream: Stream) -> bool:
        peer = next((peer for peer in self._view.peers.values() if peer.robot == stream.robot), None)
        return peer is not None and asks(self._view, stream, peer, self._gate.limits)

    def _promise(self, now: float, expected: Expected) -> bool:
        stream, message = expected.stream, expected.message
        peer = next((name for name, peer in self._view.peers.items() if peer.robot == stream.robot), None)
        if peer is None:
            return False
        shared = tuple(limit for limit in self._gate.limits if limit.shared)
        use = tuple(MARGIN * amount for amount in use_of(message.size, expected.copies, shared))
        slack, center = self._slack(expected), message.t_gen
        if center <= now:
            center, slack = now, 2.0 * self._view.peers[peer].offset.latency + ANSWERED
        lent = self._shares.lend(now, peer, center - slack, center + slack, use)
        if lent is None:
            return False
        promise = Promise(message.t_gen, lent.ends, message.size, message.scale, message.features)
        self._promised.setdefault((stream.robot, stream.key), []).append(promise)
        self._gate.promised = self._promised
        self.lent += 1
        return True

    def _slack(self, expected: Expected) -> float:
        peer = next(p for p in self._view.peers.values() if p.robot == expected.stream.robot)
        return LEAST_SLACK + SPREADS * spread(expected.stream) + peer.offset.latency

    def _forget(self, now: float) -> None:
        for place, promises in list(self._promised.items()):
            promises[:] = [p for p in promises[-REMEMBERED:] if p.ends >= now - DOUBT]
            if not promises:
                del self._promised[place]


def spread(stream: Stream) -> float:
    """How far generation times deviate from what is expected, in standard deviations [s]."""
    return stream.schedule.jitter
