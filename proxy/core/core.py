"""The decision core: takes events, returns commands. No I/O, no clock, no thread.

    core = Core(settings, specs, now)
    for command in core.handle(event): ...

The same events and settings give the same commands, whoever drives: the daemon, a simulation, a test.
"""

from collections import Counter
from dataclasses import replace
from functools import singledispatchmethod
from typing import Any

from proxy.core import events as ev
from proxy.core.allocation import Room, gifts, targets
from proxy.core.asking import Asking
from proxy.core.claims import claims
from proxy.core.codec import pack_digest, pack_state
from proxy.core.commands import AskState, Command, NoteInterest, Notice, SendDigest, SendState
from proxy.core.counts import DROPPED, Counts
from proxy.core.digests import QUESTION, DigestPacer
from proxy.core.fixed import feature, rounded
from proxy.core.gate import Gate
from proxy.core.inbox import SUPERSEDED, Waiting
from proxy.core.limits import allowance_of, limits_of, use_of
from proxy.core.mode import Mode
from proxy.core.plausible import PATIENCE, objection, objection_to_state
from proxy.core.report import report
from proxy.core.settings import CoreSettings
from proxy.core.shares import Shares
from proxy.core.stating import differs, shortened, state_of, update_of
from proxy.core.strangers import Strangers
from proxy.core.stream import Generated, Stream
from proxy.core.view import SharedView
from proxy.core.warnings import namesake_warning, transport_warnings
from proxy.core.window import WindowBuilder
from proxy.core.wire import PARTS, Digest, State, StreamDigest, tag
from utility_specs import Specs

COVERED_FLOOR = 0.1
"""Part of what we hold that traffic without a spec leaves to covered streams."""
ALLOCATION_PACE = 0.05
"""Shares are looked at anew this often at most [s]."""
STATE_PACE = 0.2
"""States follow each other at least this far apart [s]."""
RESTATE = 1.0
"""While samples come, our state is looked at this often: whether the periods are still right [s]."""


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
        self.refused: Counter[str] = Counter()
        """What was heard on Sendworthy's keys and changed nothing, by kind."""
        self.strangers = Strangers()
        self.asking = Asking(now)
        self.untold = 0
        """Streams, subscriptions and origins that did not fit into our state."""
        self._tickets = 0
        self._allocated_at = now - ALLOCATION_PACE
        self._urgent = False
        self._told = 0
        """Messages put on the air that we told of."""
        self._state = State(settings.robot, settings.zid, "", "")
        self._state_at = self._restated = now - STATE_PACE
        self._restate_at = now
        """When to look whether our state is news."""
        self._adopt_limits(now)

    def handle(self, event: ev.Event) -> list[Command]:
        """Take in one event; return what is to be done, in order."""
        return [*self._on(event), *self._advance(event.now)]

    def wake_at(self, now: float) -> float:
        """When `TimePassed` is due at the latest [s, our clock]."""
        times = [self._digest_due(now), self.asking.next_at(), now + 1.0]
        if self._restate_at < float("inf"):
            times.append(max(self._restate_at, self._state_due(now)))
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
        if self.view.claim(event.origin):
            self._restate_at = event.now
        robot = self.settings.robot
        if self.view.robot_of(event.origin) != robot:
            return [self.gate.pass_on(event.sample, "passed:relayed")]
        if self.gate.mode is Mode.PASS:
            return [self.gate.pass_on(event.sample, "passed:mode")]
        stream = self.view.stream(event.now, robot, event.key)
        # A stream that is there may have another period by and by; a new one is news.
        known = stream is None or stream.generated
        self._restate_at = min(self._restate_at, self._restated + RESTATE if known else event.now)
        if stream is None or event.delete:
            self._uncovered(event.now, 1, event.size)
        if stream is None:
            return [self.gate.pass_on(event.sample, "passed:no-spec")]
        if event.delete:
            return self.gate.delete(event.key, event.sample)
        features = {name: feature(value) for name, value in event.features.items()}
        scale = rounded(stream.information_type.scale(features))
        stream.note_generated(
            stream.generated + event.superseded + 1, Generated(event.t_gen, event.size, scale, features)
        )
        self._urgent |= self.pacer.value_changed(stream) and self.view.receivers(stream) > 0
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
        self._hear(event.now, event.digest)
        return []

    @_on.register
    def _(self, event: ev.StateHeard) -> list[Command]:
        name = tag(event.state.zid)
        peer = self.view.peers.get(name)
        if peer is None:
            return []  # we ask for it when we know the robot
        if wrong := objection_to_state(peer, event.state):
            self.refused[wrong] += 1
            return []
        before, subscriptions = transport_warnings(self.view), peer.subscriptions
        if self.view.heard_state(event.now, event.state):
            self._look_for_state(event.now, name)
        else:
            self.asking.want(event.now, name)
        told: list[Command] = [NoteInterest(peer.zid, peer.subscriptions)] * (peer.subscriptions != subscriptions)
        after = transport_warnings(self.view)
        return [*told, *(Notice("error", warning) for warning in after if warning not in before)]

    @_on.register
    def _(self, event: ev.MalformedHeard) -> list[Command]:
        self.refused[event.kind] += 1
        return []

    @_on.register
    def _(self, event: ev.StateAsked) -> list[Command]:
        self.pacer.owe(event.now, len(pack_state(self._state)), 1)
        self.pacer.forget()
        return []

    @_on.register
    def _(self, event: ev.PeerAppeared) -> list[Command]:
        if event.zid == self.settings.zid or not self.view.add_peer(event.now, event.robot, event.zid):
            return []
        name = tag(event.zid)
        self._membership(event.now)
        self.pacer.forget()
        self.asking.want(event.now, name)
        for heard, digest in self.strangers.introduce(name):
            self._hear(heard, digest)
        robot = self.view.peers[name].robot
        notices: list[Command] = [Notice("info", f"robot {robot} is on the mesh")]
        if robot != event.robot:
            notices.append(Notice("error", namesake_warning(event.robot, event.zid, robot)))
        return notices

    @_on.register
    def _(self, event: ev.PeerGone) -> list[Command]:
        peer = self.view.peers.get(tag(event.zid))
        if peer is None or peer.zid != event.zid:
            return []
        robot = peer.robot
        self.view.gone(event.zid)
        self.asking.done(tag(event.zid))
        self.shares.forget(tag(event.zid))
        self._membership(event.now)
        return [NoteInterest(event.zid, ()), Notice("info", f"robot {robot} left the mesh")]

    @_on.register
    def _(self, event: ev.InterestChanged) -> list[Command]:
        self.view.set_interest(event.keys)
        self._restate_at = event.now
        return []

    @_on.register
    def _(self, event: ev.MatchingChanged) -> list[Command]:
        self.view.set_matching(event.key, matching=event.matching)
        return []

    @_on.register
    def _(self, event: ev.SpecsChanged) -> list[Command]:
        self.view.set_specs(event.specs)
        self._restate_at = event.now
        self._adopt_limits(event.now)
        return [Notice("info", f"specs {event.specs.generation} in force")]

    @_on.register
    def _(self, event: ev.ModeChanged) -> list[Command]:
        self.gate.mode = event.mode
        self._restate_at = event.now
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
        commands: list[Command] = []
        self._allocate(now)
        if self.gate.pending is None:
            self._tickets += 1
            commands += self.gate.next(now, self._tickets)
        if now >= self._restate_at and now >= self._state_due(now):
            commands += self._send_state(now)
        if (name := self.asking.due(now)) is not None:
            self.pacer.owe(now, QUESTION, 1)
            commands.append(AskState(self.view.peers[name].name, name))
        self.view.sweep(now)
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

    def _send_digest(self, now: float) -> Command:
        digest = Digest(
            robot=self.settings.robot,
            tag=self.shares.own,
            sent=now,
            epoch=self.shares.announced(now),
            messages=self.view.messages,
            bytes=self.view.bytes,
            streams=self.pacer.changed(now, list(self.view.own())),
            grants=self.pacer.grants(self.shares.grants()),
            echoes=self.pacer.echoes(now, self.view.echoes()),
            state=self._state.number,
        )
        self._urgent, self._told = False, digest.messages
        self.pacer.sent(now, len(pack_digest(digest)), self._copies())
        return SendDigest(digest)

    def _send_state(self, now: float) -> list[Command]:
        """Publish what is new of our state, or all of it, or nothing."""
        self._restate_at, self._restated = float("inf"), now
        state, left = shortened(state_of(self.view, self.gate.mode))
        if self._state.number and not differs(self._state, state):
            return []
        state = replace(state, number=self._state.number + 1)
        update = update_of(self._state, state)
        told: list[Command] = []
        if left > self.untold:
            told.append(Notice("warning", f"{left} streams, subscriptions or origins are too many to tell the others"))
        self.untold = left
        self._state, self._state_at = state, now
        self.pacer.owe(now, len(pack_state(update or state)), self._copies())
        return [*told, SendState(state, update)]

    def _state_due(self, now: float) -> float:
        return max(self._state_at + STATE_PACE, self.pacer.state_due(now))

    def _copies(self) -> int:
        """How often a digest or a state is transmitted."""
        return len(self.view.peers) + (self.settings.relayed and bool(self.view.peers))

    def _hear(self, now: float, digest: Digest) -> None:
        """Take in a digest, if it is one that the robot can have sent."""
        peer = self.view.peers.get(digest.tag)
        if peer is None:
            if digest.tag == self.shares.own:
                self.refused["digest:forged"] += 1
            else:
                self.strangers.keep(now, digest)
            return

        def known(news: StreamDigest) -> Stream | None:
            return self.view.known(peer.robot, peer.keys.get(news.id, ""))

        if wrong := objection(now, peer, digest, known):
            self.refused[wrong] += 1
            return
        if peer.digest is not None and now - peer.digest_received > PATIENCE:
            peer.digest = None
        if self.view.heard_digest(now, digest):
            self.shares.heard(digest.tag, digest.epoch, digest.grants)
            self._look_for_state(now, digest.tag)

    def _look_for_state(self, now: float, name: str) -> None:
        """Ask a robot for its state if its digests speak of another one than we have."""
        peer = self.view.peers[name]
        if peer.state is None or (peer.digest is not None and peer.digest.state not in (0, peer.number)):
            self.asking.want(now, name)
        else:
            self.asking.done(name)

    def _digest_due(self, now: float) -> float:
        news = self.pacer.has_news(list(self.view.own()))
        # Where all plan for all, every message that was sent leaves the others less.
        sent = self.settings.coordination == "overhear" and self.view.messages != self._told
        return self.pacer.due(now, urgent=self._urgent or sent, news=news)

    def _membership(self, now: float) -> None:
        self._adopt_limits(now)
        self.shares.set_members(now, self.view.peers)
        self._urgent = True

    def _adopt_limits(self, now: float) -> None:
        robots = len(self.view.peers) + 1
        self.gate.limits = limits_of(self.view.specs, self.settings.allowance, robots)
        self.shares.set_limits(now, self.gate.limits)
        self.pacer.set_rate(allowance_of(self.view.specs, self.settings.allowance, robots))

    def _uncovered(self, now: float, count: int, size: int) -> None:
        """So many samples of `size` in all that nobody decides on go out: they lower what is left for the others."""
        each = use_of(-(-size // count), 1, self.gate.limits)
        self.shares.use_at_most(now, tuple(count * use for use in each), 1.0 - COVERED_FLOOR)
        self.view.aired(count, size)
