"""How well robots foresee when streams generate: their own, and those of others."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from statistics import median, quantiles

from studies.simulation.conditions import WARM_UP
from studies.simulation.member import Member
from studies.simulation.records import Frame
from studies.simulation.team import Team

REACH = 1.6
"""So many periods ahead a generation is looked for."""


@dataclass(slots=True)
class Errors:
    """Differences between predicted and true generation times, as parts of the period; `none` were not predicted."""

    each: list[float] = field(default_factory=list)
    none: int = 0

    def summary(self) -> tuple[float, float]:
        """Return the median and the 95th percentile; what was not predicted is off by half a period, the most."""
        every = [*self.each, *[0.5] * self.none]
        return (median(every), quantiles(every, n=20)[-1]) if len(every) > 1 else (0.5, 0.5)


@dataclass(slots=True)
class Probe:
    """Asks its robot, and those that plan for it, when they expect a sample: one period before it is generated."""

    own: Errors = field(default_factory=Errors)
    others: Errors = field(default_factory=Errors)

    def attach(self, team: Team, frames: Iterable[Frame]) -> None:
        """Ask during the flight of this team, after its warm-up."""
        streams: dict[str, list[Frame]] = {}
        for frame in frames:
            streams.setdefault(frame.key, []).append(frame)
        for own in streams.values():
            gaps = [after.t_gen - before.t_gen for before, after in pairwise(own)]
            period = median(gaps) if gaps else 0.0
            for frame in own:
                if frame.t_gen - period > WARM_UP and period > 0.0:
                    team.agenda.at(frame.t_gen - period, partial(self._ask, team, frame, period))

    def _ask(self, team: Team, frame: Frame, period: float, t: float) -> None:
        for member in team.members.values():
            if member.robot != frame.robot and not _plans(member):
                continue
            errors = self.own if member.robot == frame.robot else self.others
            times = _expected(member, frame, t, t + REACH * period)
            if times:
                errors.each.append(min(abs(each - frame.t_gen) for each in times) / period)
            else:
                errors.none += 1


def _plans(member: Member) -> bool:
    """Whether a robot plans for the others: not where each has its part of the limits."""
    return not member.core.coordination.team.splits


def _expected(member: Member, frame: Frame, t: float, until: float) -> list[float]:
    """When a robot expects samples of the stream [true time, s]."""
    now = member.now(t)
    for stream in member.core.view.streams:
        if stream.robot == frame.robot and stream.key == frame.key:
            times = stream.schedule.forecast(now, member.now(until), 8)
            return [member.clock.true(each) for each in times]
    return []
