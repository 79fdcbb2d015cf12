"""The decision core: takes events, returns commands, `Core.handle(event)`. No I/O, no clock, no thread.

The same events and settings give the same commands, whoever drives. One reaction takes an event in (`reactions/`); then
the parts go on with what is due (`_advance`). Most of what is heard is only noted until the next of them is due.
"""

from collections.abc import Callable
from functools import partial
from typing import Any, Generic, TypeVar

from proxy.core.congestion.channel import Channel
from proxy.core.coordination.budget import Budget, using
from proxy.core.coordination.coordination import Coordination
from proxy.core.gossip.gossip import Gossip
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Command, Decide, Forward
from proxy.core.model.settings import CoreSettings
from proxy.core.parts import Parts
from proxy.core.reactions.changes import Changes, TeamLimits
from proxy.core.reactions.fast_path import FastPath
from proxy.core.reactions.membership import Membership
from proxy.core.reactions.mesh_news import MeshNews
from proxy.core.reactions.own_samples import OwnSamples
from proxy.core.reactions.retention import Retention
from proxy.core.samples.gate import Gate
from proxy.core.samples.kept import Kept
from proxy.core.status import live_streams, report, streams, types
from proxy.core.view.mismatched_limits import MismatchedLimits
from proxy.core.view.view import SharedView
from proxy.core.why import stream_decisions
from utility_specs import Specs

TIDIED_EVERY = 0.1
"""What is too old is forgotten this often at most [s]."""
NOTED = frozenset({ev.SampleHanded, ev.SampleHeard, ev.DigestHeard, ev.MalformedHeard, ev.VersionHeard})
"""Events that bring about nothing by themselves, unless a sample waits, or the team has or had parts."""


PASSING = frozenset({ev.SampleHanded, ev.SampleHeard})
"""Of these, those after which samples pass as before."""
STEADY = frozenset({ev.SamplePublished, ev.TimePassed, ev.DigestHeard}) | PASSING
"""Events that change nothing of what streams need for each of their samples."""

T = TypeVar("T")


class _Part(Generic[T]):
    """A part of a core, for who looks into it between two events."""

    def __set_name__(self, _: type, name: str) -> None:
        self._name = name

    def __get__(self, core: "Core", _: type) -> T:
        part: T = getattr(core.parts, self._name)
        return part


class Core:
    """One robot's decisions."""

    view = _Part[SharedView]()
    mismatched = _Part[MismatchedLimits]()
    coordination = _Part[Coordination]()
    budget = _Part[Budget]()
    channel = _Part[Channel]()
    kept = _Part[Kept]()
    gate = _Part[Gate]()
    gossip = _Part[Gossip]()

    def __init__(self, settings: CoreSettings, specs: Specs, now: float) -> None:
        self._parts = parts = Parts.build(settings, specs, now)
        self.settings, self.counts = settings, parts.counts
        self._fast = FastPath(parts)
        self.started = self._wakes_at = self._tidied_at = now
        self._retention = Retention(parts)
        self._limits = TeamLimits(parts)
        self.news = MeshNews(parts, self._retention)
        self._samples = OwnSamples(parts)
        self._reactions = self._all_reactions()
        self._limits.adopt(now)

    def __getstate__(self) -> dict[str, Any]:
        """All that it knows, for a snapshot: who takes in which event is known anyway."""
        return {name: value for name, value in vars(self).items() if name != "_reactions"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._reactions = self._all_reactions()

    def handle(self, event: ev.Event) -> list[Command]:
        """Take in one event; return what is to be done, in order. Raises TypeError for what is no event."""
        fast, kind = self._fast, type(event)
        react = self._reactions.get(kind)
        if react is None:
            raise TypeError(f"{kind.__name__} is no event of the core")
        if (passed := fast.take(event)) is not None:  # as `pass_on` does, which would be one more call for every event
            self._wakes_at = min(self._wakes_at, fast.due_at)
            return passed
        if kind is not ev.SampleHeard:  # which concerns none of ours
            fast.conclude()
        commands, now = react(event) or [], event.now
        parts = self._parts
        self._wakes_at = min(self._wakes_at, parts.gossip.requests.due_at)  # a digest may name a state that we lack
        due = now >= self._wakes_at or now >= parts.channel.due_at
        if due or kind not in NOTED or not self.notes:
            fast.conclude()
            commands = self._advance(now, commands, answered=kind is ev.DecisionReady)
            self._retention.follow(now, commands)
            self._wakes_at = parts.due_at(now)
        elif kind in PASSING:
            return commands
        self._look_whether_samples_pass(event)
        return parts.kept.around(commands)

    def pass_on(self, event: ev.Event) -> list[Command] | None:
        """Do the same, if all that is to be done is to send a sample on or to note that it went; None: it is not."""
        passed = self._fast.take(event)
        if passed is not None:
            self._wakes_at = min(self._wakes_at, self._fast.due_at)
        return passed

    @property
    def parts(self) -> Parts:
        """All parts, with all entered in them that happened."""
        self._fast.settle()
        return self._parts

    @property
    def notes(self) -> bool:
        """Whether what is heard is only noted: no sample waits for it, and the team has no parts and had none."""
        coordination = self._parts.coordination
        return not (self._parts.gate.waits or coordination.split_in_force or coordination.told)

    def wake_at(self, now: float) -> float:
        """When `TimePassed` is due at the latest [s, our clock]; since the last event nothing can have changed that."""
        return max(self._wakes_at, now)

    @property
    def decides_soon(self) -> bool:
        """Whether samples may compete for room soon: there are streams, or others want what is planned for."""
        if len(self.view.streams):
            return True
        planned = (key for each in self.view.specs.types if each.planned for key in each.keys)
        return bool(self.budget.limits) and self.view.subscribers.want(planned)

    def status(self, now: float) -> dict[str, Any]:
        """All that can be told of the core, as plain JSON data."""
        return self._report(now) | {"streams": streams(self.parts, now)}

    def live(self, now: float) -> dict[str, Any]:
        """The same, but of the streams only what who looks again and again shows, as rows under columns."""
        return self._report(now) | {"streams": live_streams(self.parts, now)}

    def totals(self, now: float) -> dict[str, Any]:
        """The same, but in place of the streams what became of our samples by information type: that takes little."""
        return self._report(now) | {"types": types(self.parts)}

    def _report(self, now: float) -> dict[str, Any]:
        found = report(self.parts, self.news.refused, self._retention.retained, now, uptime=now - self.started)
        misread = self.news.misread_at
        return found | {"other_version_age": None if misread is None else now - misread}

    @property
    def asked(self) -> Decide | None:
        """The search whose answer is awaited, if one is."""
        pending = self.gate.search.pending
        return None if pending is None else pending.decide

    def decided_keys(self) -> list[str]:
        """The keys of ours that decisions are made on, or were lately."""
        return sorted({*self.gate.decisions.log, *(stream.key for stream in self.view.streams.own())})

    def why(self, now: float, key: str, last: int, after: int) -> dict[str, Any]:
        """Return the last decisions on our stream of a key, of those numbered above `after`, as plain JSON data."""
        return stream_decisions(self.parts, now, key, last, after)

    def _look_whether_samples_pass(self, event: ev.Event) -> None:
        if type(event) not in STEADY:
            self._fast.close()
        self._fast.open(event.now, min(self._wakes_at, self._parts.channel.due_at))
        if isinstance(event, ev.SamplePublished):
            self._fast.admit(event)

    def _all_reactions(self) -> dict[type, Callable[[Any], list[Command] | None]]:
        samples, news, parts = self._samples, self.news, self._parts
        gate, copies = parts.gate, parts.kept.copies
        members = Membership(parts, self._limits, news, self._retention)
        changes = Changes(parts, self._limits, self._retention)
        return {
            ev.SamplePublished: samples.published,
            ev.SampleReread: samples.reread,
            ev.SamplesPassed: samples.passed,
            ev.SampleHanded: lambda handed: gate.outcomes.handed(handed.now, handed.sample),
            ev.SampleRefused: samples.refused,
            ev.CopyHanded: lambda handed: copies.handed(handed.now, handed.sample, handed.to),
            ev.CopyRefused: lambda refused: copies.turned_back(refused.now, refused.sample, refused.to),
            ev.DecisionReady: gate.ready,
            ev.DecisionLate: lambda late: gate.overdue(late.now, late.ticket),
            ev.SampleHeard: parts.view.overhearing.take,
            ev.DigestHeard: lambda heard: news.hear(heard.now, heard.digest, heard.size),
            ev.StateHeard: news.state,
            ev.MalformedHeard: news.malformed,
            ev.VersionHeard: news.version,
            ev.StateAsked: lambda asked: parts.gossip.state_asked(asked.now),
            ev.PeerAppeared: members.appeared,
            ev.PeerGone: members.gone,
            ev.InterestChanged: changes.interest,
            ev.MatchingChanged: lambda told: parts.view.streams.match(told.key, matching=told.matching),
            ev.ClockChanged: changes.clock,
            ev.LinksGauged: changes.links,
            ev.SpecsChanged: changes.specs,
            ev.ModeChanged: changes.mode,
            ev.TimePassed: lambda _: None,
        }

    def _advance(self, now: float, commands: list[Command], *, answered: bool) -> list[Command]:
        """Go on with whatever can go on after an event; what one part says is passed on to the others.

        The announcement of a sample goes before it: behind it 5.0 and 7.2 % of the windows of four robots with cameras
        were over the limit over ns-3's Wi-Fi, and 0 and 1.8 are. While a search is on nothing is told that has time,
        nor, where nobody plans with it, before a sample that was `answered`: a digest held frames up by 0.5 to 1 ms.
        """
        urgent, commands, parts = False, [*commands], self._parts
        budget, channel, gossip, gate = parts.budget, parts.channel, parts.gossip, parts.gate
        if now >= channel.due_at:
            urgent = channel.look(now, self.counts.dropped)
            commands += self._limits.follow_channel(now)
        if now >= self._tidied_at + TIDIED_EVERY:
            commands += self._tidy(now)
        announcements = gossip.announcements
        parts_changed = parts.coordination.advance(
            now,
            budget.limits,
            channel.staleness,
            announcements.share,
            partial(using, budget),
            passes_at=announcements.passes_at,
        )
        budget.mute(announcements.due_at(now))
        commands += gate.next(now)
        if now < gate.search.answer_due and not (urgent or parts_changed):
            return commands
        mode, heeded = gate.appraisal.mode, not gate.appraisal.all_fits and parts.coordination.team.must_announce
        relaxed = not (heeded or channel.capacity.factors)
        has_time = relaxed and not (urgent or parts_changed)
        if answered and has_time and any(type(each) is Forward for each in commands):
            return commands
        told = gossip.advance(now, mode, urgent=urgent, parts_changed=parts_changed, relaxed=relaxed)
        return told + commands

    def _tidy(self, now: float) -> list[Command]:
        """Forget what is too old, look for whom to leave out of the team, and say what was dropped unplanned."""
        self._tidied_at = now
        self._parts.view.sweep(now)
        commands = self._limits.leave_out_mismatched(now)
        return [*commands, *self._retention.sweep(now), *self._samples.unplanned.look(now)]
