"""A mission of the study, flown by a team of cores over a network: what it is, and what specs it needs.

Robots publish from the start of the mission; the first `WARM_UP` seconds, in which they get to know each other, are flown
but not scored.
"""

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from planner import Constraint, Linear, Problem, SearchSettings
from proxy.core.limits import LEAST_ALLOWANCE
from proxy.core.settings import CoreSettings
from proxy.core.transport import UNICAST, broadcast
from studies.simulation.churn import Happening
from studies.simulation.clocks import Clock
from studies.simulation.medium import Medium, Way
from studies.simulation.records import Frame
from studies.simulation.team import Team
from studies.workload import SCENARIOS, Scenario, mission
from utility_specs import Specs, load_specs

WARM_UP = 10.0
"""Flown but not scored [s]."""
WINDOW = 2.5
"""Of the limit [s]."""
SIZE = 2_048
"""Of a message [B]."""
SLACK = 0.25
"""The limit carries so much more than whole messages [messages]: no plan gains by it, and nobody fails by a byte."""
RATE = 1e6
"""Of the medium, unless something else is said: no queue shows [B/s]."""
OPERATOR = "op"
"""Who wants everything in unicast; in broadcast every robot does."""

Coordination = Literal["shares", "overhear"]
Transport = Literal["unicast", "broadcast"]


@dataclass(frozen=True, slots=True)
class Conditions:
    """How a mission is flown.

    `limit` counts messages per `WINDOW`; with `digests_inside` it is what messages and digests may use together, else what
    is left to messages. `latency` and `jitter` are seconds, `loss`, `duplication` and `reordering` probabilities.
    """

    coordination: Coordination = "shares"
    transport: Transport = UNICAST
    limit: int = 5
    latency: float = 0.02
    jitter: float = 0.0
    loss: float = 0.0
    duplication: float = 0.0
    reordering: float = 0.0
    seconds: float = 60.0
    robots: int = 10
    iterations: int = 300
    allowance: float = 0.02
    digests_inside: bool = False
    clocks: Mapping[str, Clock] = field(default_factory=dict)
    ways: Mapping[tuple[str, str], Way] = field(default_factory=dict)
    happenings: Sequence[Happening] = ()

    @property
    def members(self) -> int:
        """Robots and, in unicast, the operator."""
        return self.robots + (self.transport == UNICAST)

    @property
    def for_messages(self) -> float:
        """What messages may use of the limit per window [B]."""
        limit = (self.limit + SLACK) * SIZE
        return limit - self._digests(limit) if self.digests_inside else limit

    @property
    def gross(self) -> float:
        """What messages and digests may use together per window [B]."""
        limit = (self.limit + SLACK) * SIZE
        if self.digests_inside:
            return limit
        return max(limit / (1.0 - self.allowance), limit + self._least)

    @property
    def _least(self) -> float:
        return LEAST_ALLOWANCE * self.members * WINDOW

    def _digests(self, gross: float) -> float:
        return max(self.allowance * gross, self._least)


@dataclass(frozen=True, slots=True)
class Mission:
    """A mission as the oracle and a central decider see it, message by message as the team's `frames`."""

    problem: Problem
    frames: tuple[Frame, ...]
    specs: Specs
    interests: Mapping[str, tuple[str, ...]]


def draw(scenario: Scenario, seed: int, how: Conditions) -> Mission:
    """Draw a mission of a scenario; the same seed gives the same one under all conditions."""
    problem = mission(
        scenario,
        seed,
        seconds=WARM_UP + how.seconds,
        robots=how.robots,
        latency=how.latency,
        constraint=Constraint("messages", WINDOW, float(how.limit)),
    )
    frames = tuple(Frame(f"r{m.stream}", f"r{m.stream}/data", m.t_gen, SIZE, {}) for m in problem.messages)
    return Mission(problem, frames, _load(_spec(problem, how)), _interests(how))


def fly(flown: Mission, how: Conditions, seed: int) -> Team:
    """Let a team fly the mission, and return it with what it sent."""
    transport = UNICAST if how.transport == UNICAST else broadcast("224.0.0.226:7449")
    team = Team(
        flown.specs,
        flown.interests,
        Medium(RATE, how.latency, how.loss, how.jitter, how.duplication, how.reordering, ways=dict(how.ways)),
        seed=seed,
        iterations=how.iterations,
        clocks=how.clocks,
        settings=CoreSettings("", "", coordination=how.coordination, transport=transport, allowance=how.allowance),
        search=SearchSettings(search="best"),
        happenings=how.happenings,
    )
    team.run(flown.frames, WARM_UP + how.seconds)
    return team


def scenario(name: str) -> Scenario:
    """Return the scenario whose name begins so; raise `ValueError` when there is none."""
    for each in SCENARIOS:
        if each.name.startswith(name):
            return each
    raise ValueError(f"no scenario {name!r}: {', '.join(each.name for each in SCENARIOS)}")


def _interests(how: Conditions) -> dict[str, tuple[str, ...]]:
    robots = [f"r{i}" for i in range(how.robots)]
    if how.transport == UNICAST:
        return dict.fromkeys(robots, ()) | {OPERATOR: ("*/data",)}
    return dict.fromkeys(robots, ("*/data",))


def _spec(problem: Problem, how: Conditions) -> str:
    """Return what an operator would write: of every robot the weight and the mean slope."""
    tables = [
        f'[[constraint]]\nkind = "throughput"\nlimit = "{how.gross / WINDOW!r} B/s"\nwindow = {WINDOW}\n',
        *(_type(problem, robot) for robot in range(how.robots)),
    ]
    return "\n".join(tables)


def _type(problem: Problem, robot: int) -> str:
    own = [m for m in problem.messages if m.stream == robot]
    slopes = [m.utility.slope for m in own if isinstance(m.utility, Linear)]
    slope = sum(slopes) / len(slopes) if slopes else 1.0
    weight = own[0].scale if own else 1.0
    return (
        f'[[information_type]]\nname = "robot-{robot}"\nkeys = ["r{robot}/data"]\naggregation = "most_recent"\n'
        f'weight = {weight!r}\nutility = {{ kind = "linear", slope = {slope!r} }}\n'
    )


def _load(text: str) -> Specs:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mission.toml"
        path.write_text(text)
        return load_specs(path)
