"""Recorded traffic flown by the daemon's cores over a simulated medium, sample by sample as it is read."""

from collections.abc import Callable, Iterator
from functools import partial
from time import perf_counter

import numpy as np

from planner import SearchSettings, start
from planner.utility import Floats
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Command, Decide, Drop, Forward
from proxy.core.model.settings import CoreSettings
from studies.replay.mission import Mission
from studies.replay.outcomes import LOST, Outcomes
from studies.replay.samples import Fate, Passed, Sample, Told
from studies.simulation.medium import Medium
from studies.simulation.member import Member
from studies.simulation.records import Frame
from studies.simulation.team import Team

LEAD = 1.0
"""Robots and operator have known each other for so long when the first sample is published [s]."""
TAIL = 1.0
"""What was published last counts for so long [s]."""


class Flight(Team):
    """One core for each robot of the mission, and one for the operator, who wants everything."""

    def __init__(
        self, mission: Mission, told: Iterator[Told], *, iterations: int, seed: int, origin: float = 0.0
    ) -> None:
        """`origin` is when the recording's first sample was published [s]: the flight counts from there."""
        super().__init__(
            mission.specs,
            {**dict.fromkeys(mission.robots, ()), mission.operator: ("**",)},
            Medium(mission.rate, mission.latency, mission.loss, seed=seed),
            seed=seed,
            iterations=iterations,
            settings=CoreSettings("", ""),
            search=SearchSettings(search="best"),
        )
        self.mission = mission
        self.outcomes = Outcomes(mission)
        self.end = 0.0
        """When the last sample was published [s since the first]."""
        self._told = told
        self._shift = LEAD - origin
        self._beside: list[tuple[float, int]] = []
        self._over = False

    def fly(self, progress: Callable[[float], object]) -> Outcomes:
        """Fly everything, and tell now and then how far it came [s]; return what became of the samples."""
        self.membership.start(0.0, ())
        self._go_on(0.0)
        while not self._over:
            self.agenda.run(LEAD + self.end)
            progress(self.end)
        self.agenda.run(LEAD + self.end + TAIL)
        self._keep_air()
        return self.outcomes

    def told_on_air(self) -> tuple[Floats, Floats]:
        """Return when robots told each other anything [s], and its bytes, all copies counted."""
        times = np.array([t for t, _ in self._beside], dtype=np.float64) - LEAD
        return times, np.array([size for _, size in self._beside], dtype=np.float64)

    def _go_on(self, t: float) -> None:
        """Put the next sample down for its time."""
        for told in self._told:
            if isinstance(told, Fate):
                self.outcomes.note(told)
                continue
            at = max(t, told.t + self._shift)
            self.end = at - LEAD
            happen = self._sample if isinstance(told, Sample) else self._passed
            self.agenda.at(at, partial(self._happen, partial(happen, told)))  # type: ignore[arg-type]
            return
        self._over = True

    def _happen(self, what: Callable[[float], None], t: float) -> None:
        what(t)
        self._keep_air()
        self._go_on(t)

    def _keep_air(self) -> None:
        """Keep of what went on the air only how much it was."""
        self._beside += [(air.t, air.size) for air in self.on_air]
        self.on_air.clear()

    def _passed(self, passed: Passed, t: float) -> None:
        """Samples of which nothing is known leave the robot."""
        member = self.members[passed.robot]
        self._feed(member, t, ev.SamplesPassed(member.now(t), "passed:no-spec", passed.count, passed.size))

    def _sample(self, sample: Sample, t: float) -> None:
        member = self.members[sample.robot]
        number, features = self.outcomes.enter(sample, t - LEAD)
        covering = self.outcomes.of(number).covering
        frame = Frame(sample.robot, sample.key, t, sample.size, dict(features))
        now = member.now(t)
        if covering is None or not covering.planned:
            reason = "passed:no-spec" if covering is None else "passed:bypass" if covering.bypass else "passed:mode"
            self._send(member, t, number, frame, reason)
            self._feed(member, t, ev.SamplesPassed(now, reason, 1, sample.size))
            return
        member.frames[number] = frame
        age = max(0.0, sample.t - sample.t_gen)
        published = ev.SamplePublished(now, number, sample.key, sample.size, now - age, None, 5, features)
        self._feed(member, t, published)

    def _execute(self, member: Member, t: float, command: Command) -> None:
        match command:
            case Forward(sample):
                reason = member.core.counts.approved(sample)
                self._send(member, t, sample, member.frames.pop(sample), reason)
                self.agenda.at(t, partial(self._handed, member, sample))
            case Drop(sample, reason):
                del member.frames[sample]
                self.outcomes.settle(sample, reason)
            case Decide():
                self._search(member, t, command)
            case _:
                super()._execute(member, t, command)

    def _search(self, member: Member, t: float, command: Decide) -> None:
        pending, begin = member.core.gate.search.pending, perf_counter()
        search = start(command.problem, self.search, command.seed)
        search.run(command.iterations)
        plan = search.plan()
        if pending is not None and pending.ticket == command.ticket:
            self.outcomes.searched(pending.sample.sample, perf_counter() - begin)
        self.agenda.at(t + self.decision_time, partial(self._decided, member, command.ticket, plan))

    def _send(self, member: Member, t: float, number: int, frame: Frame, reason: str) -> None:
        """Send a sample to the operator."""
        operator = self.mission.operator
        arrivals = self.medium.unicast(t, frame.size, member.robot, (operator,))[operator]
        self.outcomes.send(number, t - LEAD, arrivals[0] - LEAD if arrivals else LOST, reason)
        stamp = member.clock.wall_time(t)
        for arrival in arrivals:
            self.agenda.at(arrival, partial(self._hear, self.members[operator], frame, member.zid, stamp))
