"""The decision core: takes events, returns commands. No I/O, no clock, no thread.

    core = Core(settings, specs, now)
    for command in core.handle(event): ...

The same events and settings give the same commands, whoever drives: the daemon, a simulation, a test.
"""

import math
from functools import singledispatchmethod
from typing import Any

from proxy.core import events as ev
from proxy.core.allocation import Room, gifts, targets
from proxy.core.capacity import Capacity, Seen
from proxy.core.claims import claims
from proxy.core.commands import Command, Notice, SendDigest, SendState, SetPace
from proxy.core.counts import DROPPED, Counts
from proxy.core.digests import DigestPacer
from proxy.core.gate import Gate
from proxy.core.inbox import SUPERSEDED, Waiting
from proxy.core.limits import Limit, allowance_of, in_force, limits_of, use_of
from proxy.core.mode import Mode
from proxy.core.report import report
from proxy.core.settings import CoreSettings
from proxy.core.shares import Shares
from proxy.core.stream import Generated, Stream
from proxy.core.view import SharedView
from proxy.core.warnings import transport_warnings
from proxy.core.window import WindowBuilder
from proxy.core.wire import PARTS, Digest, State, StreamState, tag
from utility_specs import Specs

COVERED_FLOOR = 0.1
"""Part of what we hold that traffic without a spec leaves to covered streams."""
ALLOCATION_PACE = 0.05
"""Shares are looked at anew this often at most [s]."""
STATE_PACE = 0.2
"""States follow each other at least this far apart [s]."""


class Core:
    """One robot's decisions."""

    def __init__(self, settings: CoreSettings, specs: Specs, now: float) -> None:
        self.settings = settings
        self.started = now
        self.view = SharedView(settings, specs)
        self.counts = Counts()
        limits = limits_of(specs, settings.allowance, 1)
        self.shares = Shares(tag(settings.zid), limits, floor=settings.floor, settled_at=now + settings.settle)
        self.gate = Gate(settings, self.view, self.shares, self.counts, WindowBuilder(self.view, now))
        self.pacer = DigestPacer(now)
        self.capacity = Capacity(now, tag(settings.zid))
        self._ceilings: tuple[Limit, ...] = ()
        self._factors: tuple[float, ...] = ()
        self.malformed = 0
        self._tickets = 0
        self._allocated_at = now - ALLOCATION_PACE
        self._urgent = False
        self._state: State | None = None
        self._state_at = now - STATE_PACE
        self._adopt_limits(now)

    def handle(self, event: ev.Event) -> list[Command]:
        """Take in one event; return what is to be done, in order."""
        return [*self._on(event), *self._advance(event.now)]

    def wake_at(self, now: float) -> float:
        """When `TimePassed` is due at the latest [s, our clock]."""
        times = [self._digest_due(now), now + 1.0]
        if self._state_changed():
            times.append(self._state_at + STATE_PACE)
        times += self.capacity.wake_at(now)
        return max(min(times), now)

    def status(self, now: float) -> dict[str, Any]:
        """All that can be told of the core, as plain JSON data."""
        return report(self, now)

    @singledispatchmethod
    def _on(self, event: object) -> list[Command]:
        """Take in one event; one method per kind follows."""
        raise TypeError(f"{type(event).__name__} is no event of the core")

    @_on.register
    def _(self, event: ev.SamplePublished) -> list[Command]:
        self.counts.enter(event.sample)
        if event.superseded:
            self.counts.passed(event.superseded, SUPERSEDED)
        self.view.claim(event.origin)
        robot = self.settings.robot
        if self.view.robot_of(event.origin) != robot:
            return [self.gate.pass_on(event.sample, "passed:relayed")]
        if self.gate.mode is Mode.PASS:
            return [self.gate.pass_on(event.sample, "passed:mode")]
        stream = self.view.stream(event.now, robot, event.key)
        if stream is None or event.delete:
            self._uncovered(event.now, 1, event.size)
        if stream is None:
            return [self.gate.pass_on(event.sample, "passed:no-spec")]
        if event.delete:
            return self.gate.delete(event.key, event.sample)
        features = event.features
        scale = stream.information_type.scale(features)
        stream.note_generated(
            stream.generated + event.superseded + 1, Generated(event.t_gen, event.size, scale, features)
        )
        self._urgent |= self.pacer.value_changed(stream)
        # In shadow all go, so none gives way to a newer one.
        markovian = stream.information_type.markovian and self.gate.mode is not Mode.SHADOW
        waiting = Waiting(
            event.sample, event.key, event.size, event.t_gen, scale, event.priority, markovian, features=features
        )
        return self.gate.put(waiting)

    @_on.register
    def _(self, event: ev.SamplesPassed) -> list[Command]:
        self.counts.passed(event.count, event.reason, event.size)
        if not event.reason.startswith(DROPPED):
            self._uncovered(event.now, event.count, event.size)
        return []

    @_on.register
    def _(self, event: ev.SampleHanded) -> list[Command]:
        self.counts.hand(event.sample)
        self.gate.handed(event.sample)
        return []

    @_on.register
    def _(self, event: ev.SampleRefused) -> list[Command]:
        self.counts.drop(event.sample, "dropped:egress")
        self.gate.refused(event.sample)
        return []

    @_on.register
    def _(self, event: ev.SampleHeard) -> list[Command]:
        self.view.heard_sample(event)
        return []

    @_on.register
    def _(self, event: ev.DigestHeard) -> list[Command]:
        digest = event.digest
        if self.view.heard_digest(event.now, digest):
            self.shares.heard(digest.tag, digest.epoch, digest.grants)
            self.capacity.heard(event.now, digest)
        return []

    @_on.register
    def _(self, event: ev.StateHeard) -> list[Command]:
        before = transport_warnings(self.view)
        self.view.heard_state(event.now, event.state)
        return [Notice("error", warning) for warning in transport_warnings(self.view) if warning not in before]

    @_on.register
    def _(self, _event: ev.MalformedHeard) -> list[Command]:
        self.malformed += 1
        return []

    @_on.register
    def _(self, event: ev.PeerAppeared) -> list[Command]:
        if event.zid == self.settings.zid or not self.view.add_peer(event.now, event.robot, event.zid):
            return []
        self._membership(event.now)
        self.pacer.forget()
        return [Notice("info", f"robot {event.robot} is on the mesh")]

    @_on.register
    def _(self, event: ev.PeerGone) -> list[Command]:
        if tag(event.zid) not in self.view.peers:
            return []
        self.view.gone(event.zid)
        self.shares.forget(tag(event.zid))
        self.capacity.forget(tag(event.zid))
        self._membership(event.now)
        return [Notice("info", f"robot {event.robot} left the mesh")]

    @_on.register
    def _(self, event: ev.InterestChanged) -> list[Command]:
        self.view.set_interest(event.keys)
        return []

    @_on.register
    def _(self, event: ev.MatchingChanged) -> list[Command]:
        stream = self.view.stream(event.now, self.settings.robot, event.key)
        if stream is not None:
            stream.matching = event.matching
        return []

    @_on.register
    def _(self, event: ev.LinksGauged) -> list[Command]:
        for zid, wait in event.waits:
            self.capacity.gauged(event.now, tag(zid), wait)
        return []

    @_on.register
    def _(self, event: ev.SpecsChanged) -> list[Command]:
        self.view.set_specs(event.specs)
        self._adopt_limits(event.now)
        return [Notice("info", f"specs {event.specs.generation} in force")]

    @_on.register
    def _(self, event: ev.ModeChanged) -> list[Command]:
        self.gate.mode = event.mode
        released = self.gate.release(event.now) if event.mode is Mode.PASS else []
        return [Notice("info", f"mode {event.mode.value}"), *released]

    @_on.register
    def _(self, event: ev.DecisionReady) -> list[Command]:
        if self.gate.pending is None or event.ticket != self.gate.pending.ticket:
            return []
        return self.gate.ready(event.now, event.plan, event.error)

    @_on.register
    def _(self, _event: ev.TimePassed) -> list[Command]:
        return []

    def _advance(self, now: float) -> list[Command]:
        """Go on with whatever can go on after an event."""
        commands: list[Command] = self._follow_channel(now)
        self._allocate(now)
        if self.gate.pending is None:
            self._tickets += 1
            commands += self.gate.next(now, self._tickets)
        if self._state_changed() and now >= self._state_at + STATE_PACE:
            self._state, self._state_at = self._own_state(), now
            commands.append(SendState(self._state))
        if now >= self._digest_due(now):
            commands.append(self._send_digest(now))
        return commands

    def _allocate(self, now: float) -> None:
        """In `shares`, give away what others need more, if we hold it and do not use it."""
        if (
            self.settings.coordination != "shares"
            or now < self._allocated_at + ALLOCATION_PACE
            or not self.shares.confirmed(now)
        ):
            return
        self._allocated_at = now
        shared = tuple(limit for limit in self.gate.limits if limit.shared)  # they come first
        held = [{member: self.shares.held_by(member, k) for member in self.shares.members} for k in range(len(shared))]
        rooms = [Room(sum(of.values()), limit.window, of) for of, limit in zip(held, shared, strict=True)]
        for k, target in enumerate(targets(claims(self.view, now, shared), rooms)):
            for gift in gifts(target, held[k], shared[k].limit / PARTS):
                if gift.giver == self.shares.own:
                    self._urgent |= self.shares.grant(now, gift.taker, k, gift.amount) > 0.0

    def _follow_channel(self, now: float) -> list[Command]:
        """Let adaptive limits be what the channel bears."""
        if self.capacity.due(now):
            self.capacity.sent(now, self.view.messages, self.view.bytes)
            self.capacity.look(now, self._seen(now))
            self._urgent |= self.capacity.news(now)
        if self.capacity.factors == self._factors:
            return []
        self._factors = self.capacity.factors
        self._adopt_factors(self._factors)
        pairs = zip(self.gate.limits, self._ceilings, strict=True)
        return [SetPace(min(limit.measure.pace * limit.limit / ceiling.limit for limit, ceiling in pairs))]

    def _seen(self, now: float) -> Seen:
        streams = [stream for stream in self.view.streams() if self.view.competes(now, stream)]
        own = self.settings.robot
        wanting = (self.view.wanting(stream) for stream in streams if stream.robot == own)
        others = (stream for stream in self.view.streams() if stream.robot != own)
        factors = self.capacity.factors
        parts = [self._parts(stream) for stream in streams]
        windows = [limit.window / factor for limit, factor in zip(self._adaptive(), factors, strict=True)]
        return Seen(
            dropped=self.counts.dropped + sum(stream.generated - stream.forwarded for stream in others),
            receivers={name for names in wanting for name in names},
            longest=max((part * time for each in parts for part, time in zip(each, windows, strict=True)), default=0.0),
            each=tuple(sum(each[k] for each in parts) for k in range(len(factors))),
        )

    def _parts(self, stream: Stream) -> tuple[float, ...]:
        """What a sample takes of the ceilings of adaptive limits."""
        adaptive = self._adaptive()
        uses = use_of(stream.newest.size, self.view.copies(stream), adaptive, own=False)
        return tuple(use / limit.limit for use, limit in zip(uses, adaptive, strict=True))

    def _adaptive(self) -> tuple[Limit, ...]:
        return tuple(limit for limit in self._ceilings if limit.least < 1.0)

    def _adopt_factors(self, factors: tuple[float, ...]) -> None:
        self.gate.limits = in_force(self._ceilings, factors)
        for k, (limit, ceiling) in enumerate(zip(self.gate.limits, self._ceilings, strict=True)):
            self.shares.set_factor(k, limit.limit / ceiling.limit)
        # Less than in proportion: where little gets through, digests are what tells.
        allowance = self.settings.allowance * math.sqrt(min(factors, default=1.0))
        self.pacer.set_rate(allowance_of(self.view.specs, allowance, len(self.view.peers) + 1))

    def _send_digest(self, now: float) -> Command:
        digest = Digest(
            robot=self.settings.robot,
            tag=self.shares.own,
            sent=now,
            epoch=self.shares.announced(now),
            messages=self.view.messages,
            bytes=self.view.bytes,
            streams=self.pacer.changed(list(self.view.own())),
            grants=self.shares.grants(),
            echoes=self.view.echoes() if self.pacer.full(now) or self.capacity.delayed else (),
            capacity=self.capacity.telling(now),
        )
        self._urgent = False
        self.capacity.told(digest)
        self.pacer.sent(now, digest, len(self.view.peers) + self.settings.relayed)
        return SendDigest(digest)

    def _digest_due(self, now: float) -> float:
        news = self.pacer.has_news(list(self.view.own())) or self.capacity.speak(now)
        return self.pacer.due(now, urgent=self._urgent, news=news)

    def _membership(self, now: float) -> None:
        self._adopt_limits(now)
        self.shares.set_members(now, self.view.peers)
        self._urgent = True

    def _adopt_limits(self, now: float) -> None:
        robots = len(self.view.peers) + 1
        self._ceilings = limits_of(self.view.specs, self.settings.allowance, robots)
        self.shares.set_limits(now, self._ceilings)
        self.capacity.set_limits(now, self._ceilings)
        self._factors = ()  # so that the driver is told
        self._adopt_factors(self.capacity.factors)

    def _uncovered(self, now: float, count: int, size: int) -> None:
        """So many samples of `size` in all that nobody decides on go out: they lower what is left for the others."""
        each = use_of(-(-size // count), 1, self.gate.limits)
        self.shares.use_at_most(now, tuple(count * use for use in each), 1.0 - COVERED_FLOOR)
        self.view.aired(count, size)

    def _state_changed(self) -> bool:
        return self._state is None or self._differs(self._state, self._own_state())

    @staticmethod
    def _differs(told: State, state: State) -> bool:
        """Periods are estimates: only one that moved by a tenth is news."""
        periods = {stream.id: stream.period for stream in told.streams}
        moved = any(
            stream.id not in periods or abs(stream.period - periods[stream.id]) > 0.1 * max(stream.period, 1e-9)
            for stream in state.streams
        )
        return moved or _without_periods(told) != _without_periods(state)

    def _own_state(self) -> State:
        return State(
            robot=self.settings.robot,
            zid=self.settings.zid,
            mode=self.gate.mode.value,
            specs=self.view.specs.generation,
            streams=tuple(_stream_state(stream) for stream in self.view.own()),
            subscriptions=self.view.interest,
            wall_offset=self.settings.wall_offset,
            origins=tuple(self.view.origins),
            transport=self.settings.transport,
        )


def _without_periods(state: State) -> tuple[object, ...]:
    return (state.mode, state.specs, state.subscriptions, state.origins, len(state.streams))


def _stream_state(stream: Stream) -> StreamState:
    return StreamState(stream.id, stream.key, stream.information_type.name, stream.schedule.period)
