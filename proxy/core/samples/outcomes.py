"""What becomes of our samples: each is sent, passed on or dropped for a reason, and counted."""

from collections.abc import Iterable
from typing import NamedTuple

from planner import Aggregation
from proxy.core.interface.commands import Command, Drop, Forward
from proxy.core.model.limits import use_of
from proxy.core.model.mode import Mode
from proxy.core.model.waiting import Waiting
from proxy.core.samples.appraisal import Appraisal, Use
from proxy.core.samples.counts import Counts
from proxy.core.samples.decision_log import Why
from proxy.core.samples.decisions import Decisions, Shortcut
from proxy.core.samples.inbox import SUPERSEDED, Evicted
from proxy.core.view.stream import Sent, Stream


class Run(NamedTuple):
    """So many samples of a stream that came one after the other, from `since` until `now` [s]."""

    stream: Stream
    since: float
    now: float
    last: Waiting
    samples: int


class Outcomes:
    """Notes what becomes of samples wherever that counts: in the view, the budget and the statistics."""

    def __init__(self, appraisal: Appraisal, counts: Counts, decisions: Decisions) -> None:
        self._appraisal = appraisal
        self._view, self._budget = appraisal.view, appraisal.budget
        self._counts = counts
        self._decisions = decisions
        self._log = decisions.log
        self._first: dict[int, tuple[Stream, tuple[str, ...]]] = {}
        """Samples of `once` on their way to the mesh session, and the robots for which each is the first one."""

    def pass_on(self, sample: int, reason: str) -> Command:
        """Forward a sample that needs no decision."""
        self._counts.approve(sample, reason)
        return Forward(sample)

    def pass_unwanted(self, now: float, sample: Waiting) -> Command:
        """Nobody wants it that we know of: it takes nothing, unless it is for robots that did not say so yet."""
        if silent := self._view.members.unannounced:
            self._budget.use_at_most(now, use_of(sample.size, silent, self._budget.limits), 1.0)
        self._log.note(now, sample.key, sample, Why("passed:unwanted"))
        return self.pass_on(sample.sample, "passed:unwanted")

    def send(self, now: float, stream: Stream | None, sample: Waiting, use: Use, why: Why) -> Command:
        """Forward what was decided for."""
        self._log.note(now, sample.key, sample, why)
        if stream is not None:
            sent = Sent(min(sample.t_gen, now), now, sample.size, sample.scale, sample.features)
            if stream.information_type.aggregation is Aggregation.ONCE:
                self._first[sample.sample] = stream, self._view.subscribers.gaining(stream)
            self._view.traffic.note_sent(stream, stream.forwarded + 1, sent)
            self._settle(stream, why.reason)
        self._count_on_air(stream, sample)
        self._budget.use(now, use, sample.sample)
        return self.pass_on(sample.sample, why.reason)

    def refuse(self, now: float, stream: Stream | None, sample: Waiting, why: Why) -> Command:
        """Drop what was decided against; in `shadow` it goes all the same, and only its traffic is announced."""
        self._decisions.refused(why.lacking)
        if stream is not None:
            self._settle(stream, why.reason)
        shadowed = self._appraisal.mode_of(stream) is Mode.SHADOW
        self._log.note(now, sample.key, sample, why, shadowed=shadowed)
        if not shadowed:
            return self._drop(sample.sample, why.reason)
        self._decisions.count(Shortcut.WOULD_DROP)
        self._count_on_air(stream, sample)
        specs = self._view.specs
        if "enforce" in specs.modes or self._appraisal.mode is Mode.ENFORCE:
            # What is enforced has to do with what is left.
            self._budget.use_at_most(now, self._appraisal.use(stream, sample), 1.0 - specs.floor)
        return self.pass_on(sample.sample, "passed:shadow")

    def passed(self, run: Run, why: Why, number: int) -> None:
        """Samples of a stream were forwarded as they came; the last one is decision `number` of all."""
        self._view.streams.touch(run.now, self._view.settings.robot, run.last.key)
        self._counts.generate(run.stream.information_type.name, run.samples)
        self._settle(run.stream, why.reason, run.samples)
        self._log.note(run.now, run.last.key, run.last, why, count=run.samples, since=run.since, number=number)

    def superseded(self, now: float, stream: Stream, count: int) -> None:
        """So many samples of a stream gave way to a newer one before they were taken up."""
        self._settle(stream, SUPERSEDED, count)
        self._log.note(now, stream.key, None, Why(SUPERSEDED), count=count)

    def evict(self, now: float, evicted: Iterable[Evicted]) -> list[Command]:
        """Drop what had to leave before it was decided."""
        commands: list[Command] = []
        for each in evicted:
            stream = self._view.streams.known(self._view.settings.robot, each.key)
            if stream is not None:
                self._settle(stream, each.reason)
            self._log.note(now, each.key, None, Why(each.reason))
            commands.append(self._drop(each.sample, each.reason))
        return commands

    def handed(self, now: float, sample: int) -> None:
        """The mesh session took the sample."""
        self._first.pop(sample, None)
        self._budget.own.handed(now, sample)
        if key := self._counts.hand(sample):
            self._view.handed(key)

    def refused(self, now: float, sample: int, reason: str) -> str:
        """The mesh session did not take the sample, so it was the first for nobody; return its key."""
        self._budget.own.refused(sample)
        stream, names = self._first.pop(sample, (None, ()))
        if stream is not None:
            stream.miss(names)
        key = self._counts.drop(sample, reason)
        if key and self._view.streams.known(self._view.settings.robot, key) is not None:
            self._log.note(now, key, None, Why(reason))
        return key

    def _settle(self, stream: Stream, reason: str, count: int = 1) -> None:
        """Count what became of samples, for their stream and for its type."""
        stream.fates[reason] += count
        self._counts.decide(stream.information_type.name, reason, count)

    def _count_on_air(self, stream: Stream | None, sample: Waiting) -> None:
        """Count a sample in what we announce that we put on the air."""
        copies = self._appraisal.copies(stream)
        self._view.traffic.count(copies, copies * sample.size)

    def _drop(self, sample: int, reason: str) -> Command:
        self._counts.drop(sample, reason)
        return Drop(sample, reason)
