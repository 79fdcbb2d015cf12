"""What becomes of samples that applications of this robot publish."""

from collections.abc import Mapping

from planner import Aggregation
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Command
from proxy.core.model.lifetimes import worthless_from
from proxy.core.model.limits import use_of
from proxy.core.model.mode import Mode
from proxy.core.model.waiting import Waiting
from proxy.core.parts import Parts
from proxy.core.protocol.fixed import feature, rounded
from proxy.core.samples.counts import DROPPED, Unplanned
from proxy.core.samples.inbox import SUPERSEDED
from proxy.core.view.stream import Generated, Stream


class OwnSamples:
    """Takes samples in, and notes what the mesh session made of them."""

    def __init__(self, parts: Parts) -> None:
        self._parts = parts
        self.unplanned = Unplanned(parts.counts)

    def published(self, event: ev.SamplePublished) -> list[Command]:
        """Pass a sample on, or queue it for its decision."""
        if self._parts.view.origins.claim(event.origin):
            self._parts.gossip.states.review(event.now)
        ours = self._parts.view.origins.robot_of(event.origin) == self._parts.settings.robot
        self._parts.counts.enter(event.sample, event.key if ours else "")
        if event.superseded:
            self._parts.counts.passed(event.superseded, SUPERSEDED)
        if not ours:
            return [self._parts.gate.outcomes.pass_on(event.sample, "passed:relayed")]
        if self._parts.gate.appraisal.mode is Mode.PASS:
            return [self._parts.gate.outcomes.pass_on(event.sample, "passed:mode")]
        stream = self._parts.view.streams.touch(event.now, self._parts.settings.robot, event.key)
        # The period of a stream that is there may change by and by; a new stream is news.
        known = stream is None or stream.generated
        self._parts.gossip.states.sample_came(event.now, event.size, new=not known)
        return self._uncover(event) if stream is None else self._covered(event, stream)

    def _uncover(self, event: ev.SamplePublished) -> list[Command]:
        """Pass a sample that specs cover no more, behind those of its key that are to be read again."""
        before = [each.sample for each in self._parts.gate.undecided if each.key == event.key]
        passed = [command for each in before for command in self.reread(ev.SampleReread(event.now, each, {}))]
        return [*passed, self._pass_undecided(event.now, event.sample, event.key, event.size)]

    def _covered(self, event: ev.SamplePublished, stream: Stream) -> list[Command]:
        """Queue a sample of a stream that specs plan for; its deletion passes if they say so."""
        waiting = Waiting(event.sample, event.key, event.size, event.t_gen, 0.0, event.priority, markovian=False)
        if event.delete and stream.information_type.deletes == "bypass":
            self._uncovered(event.now, 1, event.size)
            self._keep_for_absent(stream, waiting, delete=True)
            return self._parts.gate.undecided.delete(event.now, event.key, event.sample)
        if event.superseded:
            self._parts.gate.outcomes.superseded(event.now, stream, event.superseded)
        valued = self._valued(stream, waiting, event.features, stream.generated + event.superseded + 1)
        self._keep_for_absent(stream, valued, delete=event.delete)
        return self._parts.gate.put(event.now, valued)

    def reread(self, event: ev.SampleReread) -> list[Command]:
        """Queue a sample again that was taken back when the specs changed."""
        waiting = self._parts.gate.undecided.settled(event.sample)
        if waiting is None:
            return []
        stream = self._parts.view.streams.touch(event.now, self._parts.settings.robot, waiting.key)
        if stream is None:
            passed = self._pass_undecided(event.now, event.sample, waiting.key, waiting.size)
            return [passed, *self._parts.gate.undecided.pass_deletions()]
        # A stream that was not covered for a while has forgotten its samples.
        forgotten = stream.last is None or stream.last.t_gen < waiting.t_gen
        waiting = self._valued(stream, waiting, event.features, stream.generated + forgotten)
        superseded = self._parts.gate.undecided.supersede(event.now, waiting)
        return self._parts.gate.put(event.now, waiting) if superseded is None else superseded

    def passed(self, event: ev.SamplesPassed) -> list[Command]:
        """Count samples that went straight to the mesh session."""
        self._parts.counts.passed(event.count, event.reason, event.size)
        if not event.reason.startswith(DROPPED):
            self._uncovered(event.now, event.count, event.size)
        return [*self.unplanned.look(event.now)]

    def refused(self, event: ev.SampleRefused) -> list[Command]:
        """The mesh session did not take a sample."""
        self._parts.gate.undecided.settled(event.sample)
        key = self._parts.gate.outcomes.refused(event.now, event.sample, event.reason)
        self._parts.kept.refused(key, event.sample)
        return [*self._parts.gate.undecided.pass_deletions(), *self.unplanned.look(event.now)]

    def _valued(self, stream: Stream, waiting: Waiting, extracted: Mapping[str, float], count: int) -> Waiting:
        """Return a sample, number `count` of its stream, with its worth by the specs; deletions have defaults."""
        shown = extracted or stream.information_type.completed({})
        features = {name: feature(value) for name, value in shown.items()} if shown else {}
        scale = rounded(stream.information_type.scale(features))
        generated = Generated(waiting.t_gen, waiting.size, scale, features)
        if count > stream.generated:
            self._parts.counts.generate(stream.information_type.name, count - stream.generated)
            stream.note_generated(count, generated)
        elif stream.last is not None and stream.last.t_gen == waiting.t_gen:
            stream.renew(generated)
        self._parts.gossip.digests.valued(stream)
        # In shadow all samples go, so none gives way to a newer one.
        markovian = stream.information_type.markovian and self._parts.gate.appraisal.mode_of(stream) is not Mode.SHADOW
        sample, key, size, priority = waiting.sample, waiting.key, waiting.size, waiting.priority
        return Waiting(sample, key, size, waiting.t_gen, scale, priority, markovian, features, waiting.to)

    def _keep_for_absent(self, stream: Stream, waiting: Waiting, *, delete: bool) -> None:
        """Keep a sample for robots that are away, if each sample of its stream counts; of `best` the best one does."""
        if self._parts.settings.away and not stream.information_type.markovian:
            most = 1 if stream.information_type.aggregation is Aggregation.BEST else self._parts.settings.backlog
            lifetime = worthless_from(stream.information_type.utility)
            self._parts.kept.published(waiting, lifetime, most, delete=delete)

    def _pass_undecided(self, now: float, sample: int, key: str, size: int) -> Command:
        """Pass a sample on a key that specs plan nothing for, and say why nobody decides on it."""
        self._uncovered(now, 1, size)
        covering = self._parts.view.specs.match(key)
        if covering is None:
            return self._parts.gate.outcomes.pass_on(sample, "passed:no-spec")
        return self._parts.gate.outcomes.pass_on(sample, "passed:bypass" if covering.bypass else "passed:mode")

    def _uncovered(self, now: float, count: int, size: int) -> None:
        """So many samples of `size` in all go out that nobody decides on: they lower what is left for the others."""
        each = use_of(-(-size // count), 1, self._parts.budget.limits)
        self._parts.budget.use_at_most(now, tuple(count * use for use in each), 1.0 - self._parts.view.specs.floor)
        self._parts.view.traffic.count(count, size)
