"""The decision core: takes events, returns commands. No I/O, no clock, no thread.

    core = Core(settings, specs, now)
    for command in core.handle(event): ...

The same events and settings give the same commands, whoever drives: the daemon, a simulation, a test.
"""

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from functools import singledispatchmethod
from typing import Any

from planner import Aggregation
from proxy.core.congestion.channel import Channel
from proxy.core.coordination.budget import Budget
from proxy.core.coordination.coordination import Coordination
from proxy.core.gossip.gossip import Gossip
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Command, Drop, Forward, NoteInterest, Notice, Retain
from proxy.core.model.limits import limits_of, use_of
from proxy.core.model.mode import Mode
from proxy.core.model.settings import CoreSettings
from proxy.core.model.waiting import Waiting
from proxy.core.protocol.fixed import feature, rounded
from proxy.core.protocol.messages import Digest, StreamDigest, tag
from proxy.core.samples.away import Leaving
from proxy.core.samples.counts import DROPPED, Counts
from proxy.core.samples.gate import CONSTRAINT, Gate
from proxy.core.samples.inbox import SUPERSEDED
from proxy.core.samples.kept import Kept
from proxy.core.samples.unplanned import Unplanned
from proxy.core.status import report
from proxy.core.view.interest import common
from proxy.core.view.mismatched_limits import MismatchedLimits
from proxy.core.view.peer import Peer
from proxy.core.view.plausible import PATIENCE, objection, objection_to_state
from proxy.core.view.stream import Generated, Stream
from proxy.core.view.unknown_senders import UnknownSenders
from proxy.core.view.view import SharedView
from proxy.core.view.warnings import namesake_warnings, transport_warnings
from proxy.core.window.window import WindowBuilder
from utility_specs import Specs


class Core:
    """One robot's decisions."""

    def __init__(self, settings: CoreSettings, specs: Specs, now: float) -> None:
        self.settings = settings
        self.started = now
        self.view = SharedView(settings, specs)
        self.counts = Counts()
        self._losses = Unplanned(self.counts)
        self.coordination = Coordination(now, settings, self.view)
        self.budget = Budget(self.view, self.coordination)
        windows = WindowBuilder(self.view, now)
        self.kept = Kept(settings.away)
        self.gate = Gate(self.view, self.budget, self.counts, self.kept.copies, windows)
        self.channel = Channel(now, self.view)
        self.gossip = Gossip(now, self.view, self.coordination, self.budget, self.channel)
        self.refused: Counter[str] = Counter()
        """What was heard on Sendworthy's keys and changed nothing, by kind."""
        self.unknown_senders = UnknownSenders()
        self.mismatched = MismatchedLimits(self.view.peers, self.view.streams)
        self.retained: frozenset[str] = frozenset()
        """What apps publish on these is taken from them even if nobody who is here wants it."""
        self._wakes_at = now
        self._taking_in = dict(type(self).__dict__["_on"].dispatcher.registry)
        self._adopt_limits(now)

    def handle(self, event: ev.Event) -> list[Command]:
        """Take in one event; return what is to be done, in order."""
        if type(event) not in self._taking_in:
            raise TypeError(f"{type(event).__name__} is no event of the core")
        take_in = self._taking_in[type(event)]
        commands: list[Command] = [*take_in(self, event), *self._advance(event.now)]
        self._follow(event.now, commands)
        self._wakes_at = self._due(event.now)
        return self.kept.around(commands)

    def wake_at(self, now: float) -> float:
        """When `TimePassed` is due at the latest [s, our clock]; since the last event nothing can have changed that."""
        return max(self._wakes_at, now)

    def _due(self, now: float) -> float:
        """When something is to be done that no event brings about [s]."""
        due = min(self.gossip.due_at(now), self.gate.wakes_at, self.coordination.due_at(now), now + 1.0)
        return max(min(due, self.channel.capacity.wakes_at(now)), now)

    def status(self, now: float) -> dict[str, Any]:
        """All that can be told of the core, as plain JSON data."""
        return report(self, now)

    @singledispatchmethod
    def _on(self, event: object) -> list[Command]:
        """Take in one event; one method per kind follows."""
        raise NotImplementedError

    @_on.register
    def _(self, event: ev.SamplePublished) -> list[Command]:
        if self.view.origins.claim(event.origin):
            self.gossip.states.review(event.now)
        robot = self.settings.robot
        ours = self.view.origins.robot_of(event.origin) == robot
        self.counts.enter(event.sample, event.key if ours else "")
        if event.superseded:
            self.counts.passed(event.superseded, SUPERSEDED)
        if not ours:
            return [self.gate.outcomes.pass_on(event.sample, "passed:relayed")]
        if self.gate.appraisal.mode is Mode.PASS:
            return [self.gate.outcomes.pass_on(event.sample, "passed:mode")]
        stream = self.view.streams.get(event.now, robot, event.key)
        # A stream that is there may have another period by and by; a new one is news.
        known = stream is None or stream.generated
        self.gossip.states.sample_came(event.now, event.size, new=not known)
        deletes = event.delete and (stream is None or stream.information_type.deletes == "bypass")
        if stream is None or deletes:
            self._uncovered(event.now, 1, event.size)
        if stream is None:
            return [self.gate.outcomes.pass_on(event.sample, self._unplanned(event.key))]
        if deletes:
            waiting = Waiting(event.sample, event.key, event.size, event.t_gen, 0.0, event.priority, markovian=False)
            self._keep_for_others(stream, waiting, delete=True)
            return self.gate.undecided.delete(event.key, event.sample)
        if event.superseded:
            stream.fates[SUPERSEDED] += event.superseded
        waiting = Waiting(event.sample, event.key, event.size, event.t_gen, 0.0, event.priority, markovian=False)
        valued = self._valued(stream, waiting, event.features, stream.generated + event.superseded + 1)
        self._keep_for_others(stream, valued, delete=event.delete)
        return self.gate.put(event.now, valued)

    @_on.register
    def _(self, event: ev.SampleReread) -> list[Command]:
        waiting = self.gate.undecided.settled(event.sample)
        if waiting is None:
            return []
        stream = self.view.streams.get(event.now, self.settings.robot, waiting.key)
        if stream is None:
            self._uncovered(event.now, 1, waiting.size)
            return [self.gate.outcomes.pass_on(event.sample, self._unplanned(waiting.key))]
        # A stream that was not covered for a while has forgotten its samples.
        forgotten = stream.last is None or stream.last.t_gen < waiting.t_gen
        waiting = self._valued(stream, waiting, event.features, stream.generated + forgotten)
        superseded = self.gate.undecided.supersede(waiting)
        return self.gate.put(event.now, waiting) if superseded is None else superseded

    def _valued(self, stream: Stream, waiting: Waiting, extracted: Mapping[str, float], count: int) -> Waiting:
        """Return a sample with its worth by the specs in force; it is number `count` of the stream.

        A delete that is decided shows nothing, so it has the features that samples have by default.
        """
        shown = extracted or stream.information_type.completed({})
        features = {name: feature(value) for name, value in shown.items()}
        scale = rounded(stream.information_type.scale(features))
        generated = Generated(waiting.t_gen, waiting.size, scale, features)
        if count > stream.generated:
            stream.note_generated(count, generated)
        elif stream.last is not None and stream.last.t_gen == waiting.t_gen:
            stream.renew(generated)
        self.gossip.digests.valued(stream)
        # In shadow all go, so none gives way to a newer one.
        markovian = stream.information_type.markovian and self.gate.appraisal.mode_of(stream) is not Mode.SHADOW
        return replace(waiting, scale=scale, markovian=markovian, features=features)

    def _keep_for_others(self, stream: Stream | None, waiting: Waiting, *, delete: bool) -> None:
        """Keep a sample for robots that are away, if each sample of its stream counts; of `best` the best one does."""
        if self.settings.away and stream is not None and not stream.information_type.markovian:
            most = 1 if stream.information_type.aggregation is Aggregation.BEST else self.settings.backlog
            lifetime = self.view.lifetimes.end(stream.information_type.utility)
            self.kept.published(waiting, lifetime, most, delete=delete)

    @_on.register
    def _(self, event: ev.SamplesPassed) -> list[Command]:
        self.counts.passed(event.count, event.reason, event.size)
        if not event.reason.startswith(DROPPED):
            self._uncovered(event.now, event.count, event.size)
        return []

    @_on.register
    def _(self, event: ev.SampleHanded) -> list[Command]:
        self.gate.outcomes.handed(event.now, event.sample)
        return []

    @_on.register
    def _(self, event: ev.SampleRefused) -> list[Command]:
        self.gate.undecided.settled(event.sample)
        self.kept.refused(self.gate.outcomes.refused(event.sample, event.reason), event.sample)
        return []

    @_on.register
    def _(self, event: ev.CopyHanded) -> list[Command]:
        self.kept.copies.handed(event.now, event.sample, event.to)
        return []

    @_on.register
    def _(self, event: ev.CopyRefused) -> list[Command]:
        self.kept.copies.turned_back(event.now, event.sample, event.to)
        return []

    @_on.register
    def _(self, event: ev.SampleHeard) -> list[Command]:
        self.view.overhearing.take(event)
        return []

    @_on.register
    def _(self, event: ev.DigestHeard) -> list[Command]:
        return self._hear(event.now, event.digest, event.size)

    @_on.register
    def _(self, event: ev.StateHeard) -> list[Command]:
        name = tag(event.state.zid)
        peer = self.view.peers.get(name)
        if peer is None:
            return []  # we ask for it when we know the robot
        if wrong := objection_to_state(peer, event.state):
            self.refused[wrong] += 1
            return []
        self.gossip.account.heard_state(event.now, event.state, event.size)
        before, subscriptions = transport_warnings(self.settings, self.view.peers), peer.subscriptions
        if self.view.heard_state(event.now, event.state):
            self.gossip.requests.compare(event.now, name, peer)
        else:
            self.gossip.requests.want(event.now, name)
        told: list[Command] = [NoteInterest(peer.zid, peer.subscriptions)] * (peer.subscriptions != subscriptions)
        if peer.state is not None:
            self.kept.subscribed(name, peer.subscriptions)
            told += self._retain()
        after = transport_warnings(self.settings, self.view.peers)
        wrong_transports = (Notice("error", warning) for warning in after if warning not in before)
        return [*told, *wrong_transports, *self._compare_clocks(event.now)]

    @_on.register
    def _(self, event: ev.ClockChanged) -> list[Command]:
        self.gossip.states.clock_set(event.now, event.wall_offset, event.error)
        self.view.clocks.set(event.wall_offset, event.error)
        return self._compare_clocks(event.now)

    @_on.register
    def _(self, event: ev.MalformedHeard) -> list[Command]:
        self.refused[event.kind] += event.count
        return []

    @_on.register
    def _(self, event: ev.VersionHeard) -> list[Command]:
        if (peer := self.view.peers.get(event.tag)) is not None:
            peer.speak(event.version)
        return []

    @_on.register
    def _(self, event: ev.StateAsked) -> list[Command]:
        self.gossip.state_asked(event.now)
        return []

    @_on.register
    def _(self, event: ev.PeerAppeared) -> list[Command]:
        before, known = namesake_warnings(self.settings, self.view.peers), dict(self.view.peers)
        name = tag(event.zid)
        if event.zid == self.settings.zid or not self.view.add_peer(event.now, event.robot, event.zid):
            self._lost_a_moment(event.now, name, event.zid)
            return []
        for other in known.keys() - self.view.peers.keys():  # it had to leave for the new one
            self._forget(other)
        self._membership(event.now)
        self.gossip.met(event.now, name)
        robot = self.view.peers[name].robot
        notices: list[Command] = [Notice("info", f"robot {robot} is on the mesh")]
        self.kept.appeared(event.robot, name)
        for stream in self.view.streams.own():
            if stream.key in self.kept.reached(name):
                stream.reach((name,))
        for heard, digest in self.unknown_senders.introduce(name):
            notices += self._hear(heard, digest, 0)
        return [
            *notices,
            *(
                Notice("error", said)
                for said in namesake_warnings(self.settings, self.view.peers)
                if said not in before
            ),
        ]

    @_on.register
    def _(self, event: ev.PeerGone) -> list[Command]:
        peer = self.view.peers.get(tag(event.zid))
        if peer is None or peer.zid != event.zid:
            return []
        robot = peer.robot
        self.kept.lost(event.now, self._leaving(peer))
        self.view.gone(event.zid)
        self._forget(tag(event.zid))
        self._membership(event.now)
        return [*self._retain(), NoteInterest(event.zid, ()), Notice("info", f"robot {robot} left the mesh")]

    def _lost_a_moment(self, now: float, name: str, zid: str) -> None:
        """The token of a robot that we know appears: it had vanished, too shortly for us to hear of it."""
        peer = self.view.peers.get(name)
        if peer is not None and peer.zid == zid and peer.state is not None:
            self.kept.lost(now, self._leaving(peer))
            self.kept.appeared(peer.name, name)
            self.kept.subscribed(name, peer.subscriptions)

    def _leaving(self, peer: Peer) -> Leaving:
        name = tag(peer.zid)
        once = [s for s in self.view.streams.own() if s.information_type.aggregation is Aggregation.ONCE]
        reached = frozenset(stream.key for stream in once if name in stream.reached)
        return Leaving(peer.name, name, peer.subscriptions, reached, peer.specs == self.view.specs.generation)

    def _forget(self, name: str) -> None:
        """The robot with this tag is not in the view any more."""
        self.gossip.requests.done(name)
        self.channel.capacity.forget(name)

    @_on.register
    def _(self, event: ev.InterestChanged) -> list[Command]:
        self.view.subscribers.set_own(event.keys)
        self.gossip.states.review(event.now)
        return []

    @_on.register
    def _(self, event: ev.MatchingChanged) -> list[Command]:
        self.view.streams.match(event.key, matching=event.matching)
        return []

    @_on.register
    def _(self, event: ev.LinksGauged) -> list[Command]:
        for zid, wait in event.waits:
            self.channel.capacity.evidence.link_gauged(event.now, tag(zid), wait)
        return []

    @_on.register
    def _(self, event: ev.SpecsChanged) -> list[Command]:
        self.view.streams.set_specs(event.specs)
        self.gossip.states.review(event.now)
        self.view.restart_losses()
        self._adopt_limits(event.now)
        return [*self.gate.undecided.unsettle(), *self._retain()]

    @_on.register
    def _(self, event: ev.ModeChanged) -> list[Command]:
        self.gossip.states.review(event.now)
        self.view.restart_losses()
        released = self.gate.set_mode(event.now, event.mode)
        return [*released, *self._retain()]

    @_on.register
    def _(self, event: ev.DecisionReady) -> list[Command]:
        return self.gate.ready(event)

    @_on.register
    def _(self, event: ev.DecisionLate) -> list[Command]:
        return self.gate.overdue(event.now, event.ticket)

    @_on.register
    def _(self, _event: ev.TimePassed) -> list[Command]:
        return []

    def _advance(self, now: float) -> list[Command]:
        """Go on with whatever can go on after an event."""
        commands: list[Command] = []
        urgent = self.channel.look(now, self.counts.dropped)
        if (pace := self.channel.apply()) is not None:
            self.budget.set_limits(self.channel.limits)
            self._set_rate()
            commands.append(pace)
        before = self.mismatched.found
        if self.mismatched.look(now):
            self._membership(now)
            new = self.mismatched.found - before
            commands += [Notice("error", warning) for warning in self.mismatched.warnings(new)]
        limits, waiting = self.budget.limits, self.channel.staleness
        share = self.gossip.announcements.share
        parts_changed = self.coordination.advance(now, limits, waiting, share, self.budget.using)
        self.budget.mute(self.gossip.announcements.due_at(now))
        commands += self.gate.next(now)
        commands += self.gossip.advance(now, self.gate.appraisal.mode, urgent=urgent, parts_changed=parts_changed)
        self.view.sweep(now)
        if self.kept.sweep(now):
            commands += self._retain()
        return [*commands, *self._losses.look(now)]

    def _retain(self) -> list[Command]:
        """Say what is to be taken from apps whoever is here: so nothing is missed of whoever vanishes."""
        if not self.settings.away:
            return []
        kinds = [each for each in self.view.specs.types if each.planned and not each.markovian]
        wanted = self.kept.subscriptions().union(*(peer.subscriptions for peer in self.view.peers.values()))
        keys = {key for each in kinds for key in each.keys} if self.gate.appraisal.mode is not Mode.PASS else set[str]()
        retained = frozenset(common(wanted, keys))
        if retained == self.retained:
            return []
        self.retained = retained
        return [Retain(tuple(sorted(retained)))]

    def _hear(self, now: float, digest: Digest, size: int) -> list[Command]:
        """Take in a digest, if it is one that the robot can have sent."""
        peer = self.view.peers.get(digest.tag)
        if peer is None:
            if digest.tag == tag(self.settings.zid):
                self.refused["digest:forged"] += 1
            else:
                self.unknown_senders.keep(now, digest)
            return []

        def known(news: StreamDigest) -> Stream | None:
            return self.view.streams.known(peer.robot, peer.keys.get(news.id, ""))

        if wrong := objection(now, peer, digest, known):
            self.refused[wrong] += 1
            return []
        if peer.digest is not None and now - peer.digest_received > PATIENCE:
            peer.restart()
        if self.view.heard_digest(now, digest):
            self.coordination.heard(now, digest)
            self.mismatched.heard(digest.tag)
            self.gossip.account.heard_digest(now, size)
            self.channel.capacity.digest_received(now, digest)
            self.gossip.requests.compare(now, digest.tag, peer)
        return self.view.clocks.compare(now, (peer,))

    def _membership(self, now: float) -> None:
        self._adopt_limits(now)
        self.coordination.set_members(now, self.view.peers.keys() - self.mismatched.found)

    def _adopt_limits(self, now: float) -> None:
        robots = len(self.view.peers) + 1
        self.coordination.set_limits(now, limits_of(self.view.specs, self.settings.allowance, robots))
        self.channel.adopt(now, limits_of(self.view.specs, self.settings.allowance, robots))
        self.budget.set_limits(self.channel.limits)
        self._set_rate()

    def _set_rate(self) -> None:
        follows = bool(self.channel.capacity.factors)
        self.gossip.account.set_rate(self.channel.allowance_factor, follows=follows)

    def _compare_clocks(self, now: float) -> list[Command]:
        return self.view.clocks.compare(now, self.view.peers.values())

    def _follow(self, now: float, commands: list[Command]) -> None:
        """Take note of what becomes of samples: whoever vanishes soon may not have got those that were sent to it.

        So is it with those for which there was no room: where robots share, it may be because of who has vanished.
        """
        for command in commands:
            if isinstance(command, Forward | Drop) and (key := self.kept.key_of(command.sample)) is not None:
                lost = isinstance(command, Drop) and command.reason != CONSTRAINT
                names = () if lost else self._names(key)
                self.kept.decided(now, command.sample, names, sent=isinstance(command, Forward))

    def _names(self, key: str) -> tuple[str, ...]:
        """Return the tags of those that want a sample of ours."""
        stream = self.view.streams.known(self.settings.robot, key)
        return () if stream is None else self.view.subscribers.of(stream)

    def _unplanned(self, key: str) -> str:
        """Why nobody decides on the samples of a key."""
        covering = self.view.specs.match(key)
        if covering is None:
            return "passed:no-spec"
        return "passed:bypass" if covering.bypass else "passed:mode"

    def _uncovered(self, now: float, count: int, size: int) -> None:
        """So many samples of `size` in all that nobody decides on go out: they lower what is left for the others."""
        each = use_of(-(-size // count), 1, self.budget.limits)
        self.budget.use_at_most(now, tuple(count * use for use in each), 1.0 - self.view.specs.floor)
        self.view.traffic.count(count, size)
