"""Flies a mission by a policy, each robot for itself, over the channel of the benchmark."""

from collections.abc import Callable
from dataclasses import dataclass
from time import process_time
from typing import Literal, Protocol

import numpy as np

from planner import Problem, SearchSettings
from proxy.core.interface.commands import Command, Decide
from proxy.core.model.settings import CoreSettings, broadcast
from proxy.core.protocol.messages import Digest
from studies.alone.flight import fly_alone
from studies.bench.channel import Channel
from studies.bench.flown import flown
from studies.bench.format import Mission
from studies.bench.policies import asking, load
from studies.bench.worth import reached
from studies.central import Policy
from studies.policies import FixedRate, Planned, by_rank, filling_interval, send_all, whenever_it_fits
from studies.simulation import missions
from studies.simulation.agenda import Agenda
from studies.simulation.flights import GROUP
from studies.simulation.medium import Medium
from studies.simulation.member import Member
from studies.simulation.network import OverMedium
from studies.simulation.team import Team
from studies.study.contenders import PAPER_ITERATIONS, Flown
from studies.study.tasks import ITERATIONS

RATE = 1e7
"""Of the medium [B/s]; limits lie far below, so that no queue shows."""
QUANTILES = 0.5, 0.99
"""Of decision times."""


@dataclass(frozen=True, slots=True)
class Score:
    """What a policy reached in a mission, after the warm-up.

    `utility` is a part of the bound. `sent` is the part of all samples that it sent, `over` the part of what it sent
    whose window exceeded a limit, so that the channel refused it. `told` is what robots told each other besides samples
    [B/s], `decision` how long decisions took: median and 99th percentile of processor time [s].
    """

    mission: str
    policy: str
    utility: float
    sent: float
    over: float
    told: float
    decision: tuple[float, float]

    @property
    def score(self) -> float:
        """The utility, of which as large a part is taken as exceeded a limit of all that was sent."""
        return min(self.utility, self.utility * (1.0 - self.over))


class Fly(Protocol):
    """Flies a mission over a channel that it makes on an agenda."""

    def __call__(self, mission: missions.Mission, channel: Callable[[Agenda], Channel], seed: int) -> Flown:
        """Return the flight."""


@dataclass(frozen=True, slots=True)
class BuiltIn:
    """A policy that comes along: what it is, and how it flies."""

    about: str
    fly: Fly


@dataclass
class _Team(Team):
    """A team of the daemon's cores that notes what its decisions take; what they tell each other is no sample."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.decisions: list[float] = []

    def _execute(self, member: Member, t: float, command: Command) -> None:
        begin = process_time()
        super()._execute(member, t, command)
        if isinstance(command, Decide):
            self.decisions.append(process_time() - begin)

    def _tell(self, member: Member, t: float, digest: Digest) -> None:
        assert isinstance(self.network, Channel)  # noqa: S101 - for the type checker
        with self.network.telling():
            super()._tell(member, t, digest)


def _team(search: Literal["best", "paper"], iterations: int) -> Fly:
    """Fly with the core of a daemon on each robot."""

    def fly(mission: missions.Mission, channel: Callable[[Agenda], Channel], seed: int) -> Flown:
        agenda = Agenda()
        team = _Team(
            mission.specs,
            mission.interests,
            Medium(RATE),
            seed=seed,
            iterations=iterations,
            settings=CoreSettings("", "", transport=broadcast(GROUP), digests_on_air=True),
            search=SearchSettings(search=search),
            network=channel(agenda),
            agenda=agenda,
        )
        team.run(mission.frames, mission.problem.t_end)
        return team

    return fly


def _alone(fresh: Callable[[Problem], Policy]) -> Fly:
    """Fly with a policy on each robot, which knows its own samples and what it heard."""

    def fly(mission: missions.Mission, channel: Callable[[Agenda], Channel], seed: int) -> Flown:
        return fly_alone(mission, fresh, channel, seed=seed)

    return fly


def _planned(_problem: Problem) -> Policy:
    return Planned(SearchSettings(search="best"), ITERATIONS)


BUILT_IN = {
    "best": BuiltIn("Sendworthy's daemons, best mode", _team("best", ITERATIONS)),
    "paper": BuiltIn("Sendworthy's daemons, paper mode", _team("paper", PAPER_ITERATIONS)),
    "planner": BuiltIn("best mode's search on each robot; nothing is told but samples", _alone(_planned)),
    "rank": BuiltIn("what is worth most for its size among what is expected", _alone(lambda _: by_rank)),
    "greedy": BuiltIn("whatever fits as far as known", _alone(lambda _: whenever_it_fits)),
    "fixed-rate": BuiltIn(
        "each stream at most so often that all fits", _alone(lambda p: FixedRate(filling_interval(p)))
    ),
    "all": BuiltIn("everything; the channel refuses what does not fit", _alone(lambda _: send_all)),
}
"""By name."""


def check(name: str) -> None:
    """Raise BenchError where there is no such policy."""
    if name not in BUILT_IN:
        load(name)


def fly(mission: Mission, name: str) -> Score:
    """Fly a mission by a policy of ours, or by one called `module:Class` or `file.py:Class`. Raises BenchError."""
    ready, head = flown(mission), mission.head
    channels: list[Channel] = []

    def channel(agenda: Agenda) -> Channel:
        medium = Medium(RATE, head.latency, head.loss, seed=head.seed)
        channels.append(Channel(OverMedium(medium, agenda), mission.limits))
        return channels[-1]

    if name in BUILT_IN:
        flight = BUILT_IN[name].fly(ready, channel, head.seed)
    else:
        kind = load(name)
        flight = _alone(lambda _: asking(name, kind))(ready, channel, head.seed)
    return _scored(mission, ready, name, flight, channels[-1])


def _scored(mission: Mission, ready: missions.Mission, name: str, flight: Flown, channel: Channel) -> Score:
    head, numbers = mission.head, {id(frame): i for i, frame in enumerate(ready.frames)}
    sent = [air for air in flight.on_air if air.frame is not None and air.t >= head.warm_up]
    told = sum(air.size for air in flight.on_air if air.frame is None and air.t >= head.warm_up)
    refused = sum(t >= head.warm_up for t in channel.refused)
    generated = sum(frame.t_gen >= head.warm_up for frame in ready.frames)
    times = np.quantile(flight.decisions, QUANTILES).tolist() if flight.decisions else [0.0, 0.0]
    return Score(
        head.name,
        name,
        reached(mission, numbers, flight.deliveries) / head.bound,
        len(sent) / max(generated, 1),
        refused / max(len(sent), 1),
        told / (head.seconds - head.warm_up),
        (times[0], times[1]),
    )
