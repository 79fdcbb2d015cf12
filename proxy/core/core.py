"""The decision core: takes events, returns commands. No I/O, no clock, no thread.

    core = Core(settings, specs, now)
    for command in core.handle(event): ...

The same events and settings give the same commands, whoever drives: the daemon, a simulation, a test.
"""

import math
from collections import Counter
from dataclasses import replace
from functools import singledispatchmethod
from typing import Any

from proxy.core import events as ev
from proxy.core.asking import Asking
from proxy.core.capacity import BEAT
from proxy.core.channel import Channel
from proxy.core.codec import pack_digest, pack_state
from proxy.core.commands import AskState, Command, Drop, NoteInterest, Notice, SendDigest, SendState
from proxy.core.counts import DROPPED, Counts
from proxy.core.digests import ON_AIR, QUESTION, SLOW, DigestPacer
from proxy.core.fixed import feature, rounded
from proxy.core.gate import Gate
from proxy.core.inbox import SUPERSEDED, Waiting
from proxy.core.layout import Layout
from proxy.core.limits import allowance_of, limits_of, use_of
from proxy.core.mode import Mode
from proxy.core.plausible import PATIENCE, objection, objection_to_state
from proxy.core.report import report
from proxy.core.settings import CoreSettings
from proxy.core.shares import Shares
from proxy.core.stating import WALL_STEP, differs, shortened, state_of, update_of
from proxy.core.strangers import Strangers
from proxy.core.stream import Generated, Stream
from proxy.core.view import SharedView
from proxy.core.wall import WallClocks
from proxy.core.warnings import namesake_warning, transport_warnings
from proxy.core.window import WindowBuilder
from proxy.core.wire import Digest, Echo, State, StreamDigest, tag
from utility_specs import Specs

COVERED_FLOOR = 0.1
"""Part of what we hold that traffic without a spec leaves to covered streams."""
LEADERS_PART = 0.35
"""Of what all robots may tell each other, this part is for the one that leads."""
AHEAD = 0.15
"""Others are lent what they need so much before they need it [s]."""
ALL_PART = 0.3
"""Where one robot leads, this part of the allowance is for telling all what concerns only some..."""
ALL_PACE = 30.0
"""... and they are told at least this often [s]."""
NEWS_PACE = 1.0
"""Who leads hears news that are not urgent this often [s]."""
STRAGGLER_PACE = 0.3
"""Those who do not say that they follow are told of who leads this often [s]."""
ECHO_PACE = 5.0
"""Digests that concern one robot echo its own this often [s]."""
MOST_AT_ONCE = 8
"""Digests that go out at the same time."""
HELLO = 0.5
"""So long after it settled a robot waits with its first digest for somebody to lead [s]."""
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
        windows = WindowBuilder(self.view, now)
        self.gate = Gate(settings, self.view, self.shares, self.counts, windows)
        self.layout = Layout(self.view, self.shares, self.gate, windows)
        self.pacer = DigestPacer(now)
        self.channel = Channel(now, self.view, self.shares, self.gate, self.counts)
        self.refused: Counter[str] = Counter()
        """What was heard on Sendworthy's keys and changed nothing, by kind."""
        self.strangers = Strangers()
        self.asking = Asking(now)
        self.clocks = WallClocks(self.view)
        self.untold = 0
        """Streams, subscriptions and origins that did not fit into our state."""
        self._keys: dict[int, str] = {}
        """Of our samples that are not handed over yet."""
        self._tickets = 0
        self._urgent = False
        self._settled_at = now + settings.settle
        self._told_all_at = self._told_at = now
        self._echoed_at: dict[str, float] = {}
        self._told_epoch = 0
        """Epochs are told at once, and paid for later."""
        self._told_messages = 0
        """Messages put on the air that we told of."""
        self._state = State(settings.robot, settings.zid, "", "")
        self._state_at = self._restated = now - STATE_PACE
        self._restate_at = now
        """When to look whether our state is news."""
        self._next_digest = -math.inf
        """When the next digest is due, as things are since the last event [s]."""
        self._taking_in = type(self).__dict__["_on"].dispatcher.dispatch
        self._adopt_limits(now)

    def handle(self, event: ev.Event) -> list[Command]:
        """Take in one event; return what is to be done, in order."""
        commands: list[Command] = [*self._taking_in(type(event))(self, event), *self._advance(event.now)]
        self._forget_dropped(commands)
        return commands

    def wake_at(self, now: float) -> float:
        """When `TimePassed` is due at the latest [s, our clock]."""
        digest_due = now + 1.0 if self.layout.pending else self._next_digest
        times = [digest_due, self.gate.wakes_at, self.asking.next_at(), now + 1.0]
        if self.settings.coordination == "shares":
            times.append(self.layout.due_at)
        times += self.channel.capacity.wake_at(now)
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
        self._keys[event.sample] = event.key
        if event.superseded:
            self.counts.passed(event.superseded, SUPERSEDED)
        if self.view.claim(event.origin):
            self._restate_at = event.now
        robot = self.settings.robot
        if self.view.robot_of(event.origin) != robot:
            del self._keys[event.sample]
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
        key = self._keys.pop(event.sample, None)
        if key is not None:
            self.view.handed(key)
        return []

    @_on.register
    def _(self, event: ev.SampleRefused) -> list[Command]:
        self.counts.drop(event.sample, "dropped:egress")
        self.gate.refused(event.sample)
        self._keys.pop(event.sample, None)
        return []

    @_on.register
    def _(self, event: ev.SampleHeard) -> list[Command]:
        self.view.heard_sample(event)
        return []

    @_on.register
    def _(self, event: ev.DigestHeard) -> list[Command]:
        return self._hear(event.now, event.digest)

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
        wrong_transports = (Notice("error", warning) for warning in after if warning not in before)
        return [*told, *wrong_transports, *self._compare_clocks(event.now)]

    @_on.register
    def _(self, event: ev.ClockChanged) -> list[Command]:
        if abs(event.wall_offset - self._state.wall_offset) > WALL_STEP:
            self._restate_at = event.now
        self.view.wall_offset = event.wall_offset
        return self._compare_clocks(event.now)

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
        robot = self.view.peers[name].robot
        notices: list[Command] = [Notice("info", f"robot {robot} is on the mesh")]
        for heard, digest in self.strangers.introduce(name):
            notices += self._hear(heard, digest)
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
        self.channel.capacity.forget(tag(event.zid))
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
    def _(self, event: ev.LinksGauged) -> list[Command]:
        for zid, wait in event.waits:
            self.channel.capacity.gauged(event.now, tag(zid), wait)
        return []

    @_on.register
    def _(self, event: ev.SpecsChanged) -> list[Command]:
        self.view.set_specs(event.specs)
        self._restate_at = event.now
        self.view.restart_losses()
        self._adopt_limits(event.now)
        return [Notice("info", f"specs {event.specs.generation} in force")]

    @_on.register
    def _(self, event: ev.ModeChanged) -> list[Command]:
        self.gate.mode = event.mode
        self._restate_at = event.now
        self.view.restart_losses()
        released = self.gate.release(event.now) if event.mode is Mode.PASS else []
        return [Notice("info", f"mode {event.mode.value}"), *released]

    @_on.register
    def _(self, event: ev.DecisionReady) -> list[Command]:
        if self.layout.answered(event.ticket):
            self._urgent |= self.layout.lend(event.now, event.plan, event.now + self._speaks_again())
            return []
        if self.gate.pending is None or event.ticket != self.gate.pending.ticket:
            return []
        return self.gate.ready(event.now, event.plan, event.error)

    @_on.register
    def _(self, _event: ev.TimePassed) -> list[Command]:
        return []

    def _advance(self, now: float) -> list[Command]:
        """Go on with whatever can go on after an event."""
        commands: list[Command] = []
        self._urgent |= self.channel.look(now)
        if (pace := self.channel.follow()) is not None:
            self._set_rate()
            commands.append(pace)
        self._lay_out(now, commands)
        if self.gate.pending is None:
            self._tickets += 1
            commands += self.gate.next(now, self._tickets)
            self._urgent |= self.gate.wakes_at < math.inf
        if now >= self._restate_at and now >= self._state_due(now):
            commands += self._send_state(now)
        if (name := self.asking.due(now)) is not None:
            self.pacer.owe(now, QUESTION, 1)
            commands.append(AskState(self.view.peers[name].name, name))
        self.view.sweep(now)
        if not self.layout.pending:
            self._tell(now, commands)
        return commands

    def _tell(self, now: float, commands: list[Command]) -> None:
        """Send the digests that are due, and see when the next one is."""
        for _ in range(MOST_AT_ONCE):
            self._next_digest = self._digest_due(now)
            if now < self._next_digest:
                return
            commands.append(self._send_digest(now))
        self._next_digest = self._digest_due(now)

    def _lay_out(self, now: float, commands: list[Command]) -> None:
        """In `shares`, and when it falls to us, plan what others should send, as soon as we can tell them."""
        if self.settings.coordination != "shares":
            return
        self.shares.confirmed(now)
        self._set_rate()
        if now >= self.pacer.due(now, urgent=True, news=True, copies=1):
            self._tickets += 1
            before = self.layout.lent
            commands += self.layout.ask(now, self._tickets, self.gate.inbox)
            self._urgent |= self.layout.lent > before

    def _set_rate(self) -> None:
        """A part of what all may tell each other is for who plans for all; the others have news."""
        robots, part = len(self.view.peers) + 1, 1.0
        if self.settings.coordination == "shares" and self.shares.leader and robots > 1:
            part = LEADERS_PART * robots if self.shares.leads else 1.0 - LEADERS_PART
        allowance = self.settings.allowance * self.channel.part
        self.pacer.set_rate(part * allowance_of(self.view.specs, allowance, robots))

    def _speaks_again(self) -> float:
        """How far ahead we have to plan: until what we say after the next digest is heard [s]."""
        latency = max((peer.offset.latency for peer in self.view.peers.values()), default=0.0)
        return self.pacer.interval + latency + AHEAD

    def _send_digest(self, now: float) -> Command:
        to = self._addressee(now)
        self._told_at = now
        if not to:
            self._told_all_at = now
        digest = Digest(
            robot=self.settings.robot,
            tag=self.shares.own,
            sent=now,
            epoch=self.shares.epoch,
            messages=self.view.messages,
            bytes=self.view.bytes,
            streams=self.pacer.changed(now, list(self.view.own())),
            grants=self.pacer.grants(to),
            echoes=self.pacer.echoes(now, self._echoes(to)),
            state=self._state.number,
            capacity=self.channel.capacity.telling(now),
        )
        self.channel.capacity.told(digest)
        self._told_epoch, self._told_messages = self.shares.epoch, digest.messages
        self.view.sent_digest(now)
        self.pacer.sent(now, self._size_of(digest), 1 if to else self._digest_copies())
        self._urgent = bool(self.pacer.addressee(self.shares.grants(now)))
        return SendDigest(digest, to)

    def _all_pace(self) -> float:
        """How often all are told what concerns only some [s]."""
        return min(ALL_PACE, max(SLOW, self._digest_copies() * self.pacer.interval / ALL_PART))

    def _straggler(self, now: float) -> str:
        """Who has to be told again who leads: each in its turn."""
        late = self.shares.stragglers if now >= self._told_at + STRAGGLER_PACE else []
        return late[int(now / STRAGGLER_PACE) % len(late)] if late else ""

    def _next_to_time(self, now: float) -> str:
        """While an adaptive limit is used, all are told something in turn: how long it takes tells of the channel."""
        names = sorted(self.view.peers) if self.channel.capacity.speak(now) else []
        return names[int(now / BEAT) % len(names)] if names else ""

    def _addressee(self, now: float) -> str:
        """In `shares`, news concern who leads, and what is lent whom it is lent to; nobody: all are told.

        All are told of an epoch, and now and then of the rest.
        """
        shares, peers = self.shares, self.view.peers
        if self.settings.coordination != "shares" or not peers:
            return ""
        if shares.leads:
            if self._told_epoch != shares.epoch:
                return ""
            to = self.pacer.addressee(shares.grants(now)) or self._straggler(now) or self._next_to_time(now)
            return to if to in peers else ""
        return shares.leader if shares.leader in peers and now < self._told_all_at + self._all_pace() else ""

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

    def _size_of(self, digest: Digest) -> int:
        """The size of a digest [B]; on the air its key has no number to stand for it."""
        return len(pack_digest(digest)) + (ON_AIR + len(self.settings.robot) if self.settings.digests_on_air else 0)

    def _digest_copies(self) -> int:
        """How often a digest for all is transmitted."""
        return 1 if self.settings.digests_on_air and self.view.peers else self._copies()

    def _copies(self) -> int:
        """How often a state is transmitted."""
        return len(self.view.peers) + (self.settings.relayed and bool(self.view.peers))

    def _hear(self, now: float, digest: Digest) -> list[Command]:
        """Take in a digest, if it is one that the robot can have sent."""
        peer = self.view.peers.get(digest.tag)
        if peer is None:
            if digest.tag == self.shares.own:
                self.refused["digest:forged"] += 1
            else:
                self.strangers.keep(now, digest)
            return []

        def known(news: StreamDigest) -> Stream | None:
            return self.view.known(peer.robot, peer.keys.get(news.id, ""))

        if wrong := objection(now, peer, digest, known):
            self.refused[wrong] += 1
            return []
        if peer.digest is not None and now - peer.digest_received > PATIENCE:
            peer.digest = None
        if self.view.heard_digest(now, digest):
            if digest.streams:
                self.layout.hurry()
            grants = digest.grants if peer.offset.known else ()
            uncertainty = peer.offset.uncertainty(now) if grants else 0.0
            self.shares.heard(now, digest.tag, digest.epoch, grants, ours=peer.offset.ours, uncertainty=uncertainty)
            self.channel.capacity.heard(now, digest)
            self._look_for_state(now, digest.tag)
        return self.clocks.compare(now, (peer,))

    def _look_for_state(self, now: float, name: str) -> None:
        """Ask a robot for its state if its digests speak of another one than we have."""
        peer = self.view.peers[name]
        if peer.state is None or (peer.digest is not None and peer.digest.state not in (0, peer.number)):
            self.asking.want(now, name)
        else:
            self.asking.done(name)

    def _echoes(self, to: str) -> tuple[Echo, ...]:
        """What a digest echoes: of whom it is sent to alone, or of all."""
        if not to:
            return self.view.echoes()
        known = self.view.peers[to].offset.known
        pace = SLOW if self.channel.capacity.factors else ECHO_PACE
        if known and self._told_at - self._echoed_at.get(to, -math.inf) < pace:
            return ()
        self._echoed_at[to] = self._told_at
        return tuple(echo for echo in self.view.echoes() if echo.peer == to)

    def _digest_due(self, now: float) -> float:
        own = list(self.view.own())
        if self.settings.coordination == "shares" and self.view.peers:
            if not self.shares.epoch and now < self._settled_at + HELLO:
                return self._settled_at + HELLO
            if self._told_epoch != self.shares.epoch:
                return now
        if self.view.peers and self.pacer.unknown(own) and self.pacer.solvent:
            return max(now, self._told_at + STRAGGLER_PACE)
        to = self._addressee(now)
        sharing = self.settings.coordination == "shares" and bool(self.view.peers)
        all_due = self._told_all_at + self._all_pace()
        if sharing and self.shares.leads and not to and now < all_due:
            retold = self._told_at + STRAGGLER_PACE if self.shares.stragglers else math.inf
            return max(now, min(retold, all_due))
        speak = self.channel.capacity.speak(now)
        news = speak or self.pacer.has_news(own)
        # Where all plan for all, every message leaves the others less; who should overhear it may have lost it.
        sent = not sharing and self.view.messages != self._told_messages
        urgent = self._urgent or sent
        copies, spare = 1 if to else max(1, self._digest_copies()), 1 if sharing else 2
        due = self.pacer.due(now, urgent=urgent, news=news, copies=copies, spare=spare)
        # What could be urgent later is not spent on news that nobody waits for.
        return due if urgent or speak or not to else max(due, self._told_at + NEWS_PACE)

    def _membership(self, now: float) -> None:
        self._adopt_limits(now)
        self.shares.set_members(now, self.view.peers)
        self._urgent = True

    def _adopt_limits(self, now: float) -> None:
        robots = len(self.view.peers) + 1
        self.channel.adopt(now, limits_of(self.view.specs, self.settings.allowance, robots))
        self._set_rate()

    def _compare_clocks(self, now: float) -> list[Command]:
        return self.clocks.compare(now, self.view.peers.values())

    def _forget_dropped(self, commands: list[Command]) -> None:
        for command in commands:
            if isinstance(command, Drop):
                self._keys.pop(command.sample, None)

    def _uncovered(self, now: float, count: int, size: int) -> None:
        """So many samples of `size` in all that nobody decides on go out: they lower what is left for the others."""
        each = use_of(-(-size // count), 1, self.gate.limits)
        self.shares.use_at_most(now, tuple(count * use for use in each), 1.0 - COVERED_FLOOR)
        self.view.aired(count, size)
