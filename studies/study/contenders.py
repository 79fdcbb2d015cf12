"""Who takes part in the study, by name: how each decides, and what of a task matters to it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter
from typing import Literal, Protocol

from planner import Problem, SearchSettings
from proxy.core.interface.commands import Command, Decide
from proxy.core.model.settings import UNICAST, CoreSettings, broadcast
from studies.alone.flight import fly_alone
from studies.central import Policy
from studies.policies import (
    FixedRate,
    Planned,
    RandomSends,
    Receding,
    by_age,
    by_rank,
    filling_interval,
    whenever_it_fits,
)
from studies.simulation import records
from studies.simulation.agenda import Agenda
from studies.simulation.flights import GROUP
from studies.simulation.medium import Medium
from studies.simulation.member import Member
from studies.simulation.missions import Mission
from studies.simulation.team import Team
from studies.study.networks import Carry, own_rate
from studies.study.tasks import ITERATIONS, Task


class Flown(records.Flown, Protocol):
    """A flight that is over, with what decisions took."""

    @property
    def decisions(self) -> Sequence[float]:
        """Seconds each."""


Fly = Callable[[Task, Mission, Carry], Flown]


@dataclass(frozen=True, slots=True)
class Contender:
    """What it is called in figures and how it flies, with so many `iterations` where nothing else is said.

    `random` ones know no limit: their level is a probability.
    """

    title: str
    fly: Fly
    iterations: int = ITERATIONS
    random: bool = False


@dataclass
class TimedTeam(Team):
    """A team that notes what its decisions take."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.decisions: list[float] = []

    def _execute(self, member: Member, t: float, command: Command) -> None:
        begin = perf_counter()
        super()._execute(member, t, command)
        if isinstance(command, Decide):
            self.decisions.append(perf_counter() - begin)


def _team(search: SearchSettings) -> Fly:
    def fly(task: Task, mission: Mission, carry: Carry) -> Flown:
        agenda = Agenda()
        team = TimedTeam(
            mission.specs,
            mission.interests,
            Medium(own_rate(task)),
            seed=task.seed,
            iterations=task.iterations,
            settings=CoreSettings(
                "",
                "",
                transport=UNICAST if task.unicast else broadcast(GROUP),
                digests_on_air=not task.unicast,
            ),
            search=replace(search, exploration=task.exploration),
            network=carry(agenda),
            agenda=agenda,
        )
        team.run(mission.frames, mission.problem.t_end)
        return team

    return fly


PAPER_ITERATIONS = 1_500
"""Of the method of the paper in its study."""


def _alone(fresh: Callable[[Task, Problem], Policy]) -> Fly:
    """Let each robot decide by a policy and what it heard of the others' messages; nobody tells anything else."""

    def fly(task: Task, mission: Mission, carry: Carry) -> Flown:
        return fly_alone(mission, partial(fresh, task), carry, seed=task.seed, broadcast=not task.unicast)

    return fly


def _planned(search: Literal["best", "paper"]) -> Fly:
    return _alone(
        lambda task, _: Planned(SearchSettings(search=search, exploration=task.exploration), task.iterations, task.seed)
    )


CONTENDERS = {
    "best": Contender("best mode", _team(SearchSettings(search="best"))),
    "paper": Contender("paper mode", _team(SearchSettings(search="paper")), PAPER_ITERATIONS),
    "paper-alone": Contender("the paper's method", _planned("paper"), PAPER_ITERATIONS),
    "best-alone": Contender("best search, nothing told", _planned("best")),
    "receding": Contender("receding horizon", _alone(lambda _task, _problem: Receding())),
    "rank": Contender("by rank", _alone(lambda _task, _problem: by_rank)),
    "age": Contender("age index", _alone(lambda _task, _problem: by_age)),
    "fixed-rate": Contender("fixed rate", _alone(lambda _, problem: FixedRate(filling_interval(problem)))),
    "greedy": Contender("whatever fits", _alone(lambda _task, _problem: whenever_it_fits)),
    "random": Contender(
        "random dropping", _alone(lambda task, _: RandomSends(task.level, task.seed, limited=False)), random=True
    ),
}
"""By name: those that fly."""
BOUND, CENTRAL = "bound", "central"
"""Those that do not: the linear programme, and one decider who hears of everything at once."""
RESERVE, STATIC = "reserve", "static"
"""Of real traffic alone, and without ns-3, too: senders that do not plan, one for all, or each with its part."""
TITLES = {name: each.title for name, each in CONTENDERS.items()} | {
    BOUND: "offline bound",
    CENTRAL: "one decides for all",
    RESERVE: "greedy with a reserve",
    STATIC: "fixed parts",
}
