"""Missions of real traffic, drawn from a seed: what applications publish, who wants it, specs, and the problem."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from planner import Aggregation, Constraint, Message, Problem, Stream
from planner.utility import Floats
from studies.simulation import conditions, missions
from studies.simulation.missions import OPERATOR, scenario, specs_of
from studies.simulation.records import Frame
from studies.simulation.traffic.kinds import Kind
from studies.simulation.traffic.workloads import WORKLOADS, Workload
from utility_specs import Specs
from utility_specs.digests import LEAST_RATE

RATE = 1e7
"""Of the medium [B/s]: limits lie far below, so that no queue shows."""
WARM_UP = 5.0
"""Flown but not scored [s]."""
ALONE = "all"
"""The robot that publishes everything where one decides for all."""
UNIFORM = "uniform-"
"""So the names of the workloads of equal messages begin; one of its scenarios follows."""
ALLOWANCE = 0.02
"""Part of the limit that all a team tells each other may use, if that is more than the least allowance a robot."""
RED_LASTS, RED_PAUSES, RED_AMOUNT = (3.0, 6.0), (2.0, 8.0), (0.2, 0.6)
"""An event [s], the time to the next one [s], and the part of the image that is red then; all uniformly drawn."""


@dataclass(frozen=True)
class Mission:
    """What a team flies, frame by frame; `problem` has the same messages in the same order, with their true utility.

    `limit` is what may be sent in `window` [s], copies and what robots tell each other included [B]; `carried` is what
    messages may use where nobody need tell anything, as `specs_alone` say. `small` and `alarms` are frames by index.
    What the `receivers` get is worth something.
    """

    problem: Problem
    frames: tuple[Frame, ...]
    specs: Specs
    interests: Mapping[str, tuple[str, ...]]
    specs_alone: Specs
    limit: float
    carried: float
    window: float
    small: frozenset[int] = frozenset()
    alarms: frozenset[int] = frozenset()
    receivers: tuple[str, ...] = (OPERATOR,)

    @property
    def allowed(self) -> float:
        """What the whole team may tell each other, all copies and framing counted [B/s]."""
        return max(ALLOWANCE * self.limit / self.window, LEAST_RATE * len(self.interests))

    @cached_property
    def generated(self) -> dict[int, tuple[Floats, Floats]]:
        """By stream when its samples are generated [s], and their scales."""
        made: dict[int, list[Message]] = {}
        for message in self.problem.messages:
            made.setdefault(message.stream, []).append(message)
        return {of: (np.array([m.t_gen for m in own]), np.array([m.scale for m in own])) for of, own in made.items()}

    @property
    def robots(self) -> list[str]:
        """Who publishes anything, in order."""
        return sorted({frame.robot for frame in self.frames}, key=lambda name: (len(name), name))


def draw(name: str, robots: int, seed: int, seconds: float, *, latency: float, everybody: bool = False) -> Mission:
    """Draw a mission of `seconds` in all; the same seed gives the same traffic at every latency [s].

    An operator wants everything; where samples are broadcast `everybody` does. Raises KeyError for an unknown workload.
    """
    if name.startswith(UNIFORM):
        return _uniform(name.removeprefix(UNIFORM), robots, seed, seconds, latency, everybody=everybody)
    return draw_from(WORKLOADS[name](robots), seed, seconds, latency=latency, everybody=everybody)


def draw_from(workload: Workload, seed: int, seconds: float, *, latency: float, everybody: bool = False) -> Mission:
    """Draw a mission of a workload, as `draw` does."""
    robots, random = len(workload.robots), np.random.default_rng(seed)
    reds = list(_reds(random, robots, seconds))
    streams = [(robot, kind) for robot, kinds in enumerate(workload.robots) for kind in kinds]
    drawn = [
        (stream, frame)
        for stream, (robot, kind) in enumerate(streams)
        for frame in _frames(random, robot, kind, seconds, [red[1:] for red in reds if red[0] == robot])
    ]
    drawn.sort(key=lambda each: (each[1].t_gen, each[0]))
    messages = tuple(_message(stream, streams[stream][1], frame, latency) for stream, frame in drawn)
    limit, specs = workload.rate * workload.window, specs_of(workload.spec())
    problem = Problem(
        tuple(Stream(robot, Aggregation(kind.aggregation)) for robot, kind in streams),
        messages,
        0,
        (Constraint("throughput", workload.window, limit),),
        (),
        t_start=0.0,
        t_end=seconds,
        goes_on=False,
    )
    kinds = [streams[stream][1] for stream, _ in drawn]
    return Mission(
        problem,
        tuple(frame for _, frame in drawn),
        specs,
        _interests([f"r{robot}" for robot in range(robots)], everybody=everybody),
        specs,
        limit,
        limit,
        workload.window,
        frozenset(i for i, kind in enumerate(kinds) if kind.small),
        frozenset(i for i, kind in enumerate(kinds) if kind.alarm),
    )


def alone(mission: Mission) -> Mission:
    """Return the mission as one robot flies it that publishes all streams to those to whom they are worth anything."""
    return replace(
        mission,
        frames=tuple(replace(frame, robot=ALONE) for frame in mission.frames),
        specs=mission.specs_alone,
        interests={ALONE: (), **{name: mission.interests[name] for name in mission.receivers}},
    )


def _interests(robots: list[str], *, everybody: bool) -> dict[str, tuple[str, ...]]:
    wanted: tuple[str, ...] = ("**",) if everybody else ()
    return {**dict.fromkeys(robots, wanted), OPERATOR: ("**",)}


def _reds(draw: np.random.Generator, robots: int, seconds: float) -> Iterator[tuple[int, float, float, float]]:
    """Yield which robot sees red, from when to when [s], and how much; one at a time."""
    begin = draw.uniform(*RED_PAUSES)
    while begin < seconds:
        end = begin + draw.uniform(*RED_LASTS)
        yield int(draw.integers(robots)), begin, end, draw.uniform(*RED_AMOUNT)
        begin = end + draw.uniform(*RED_PAUSES)


def _frames(
    draw: np.random.Generator, robot: int, kind: Kind, seconds: float, reds: list[tuple[float, float, float]]
) -> Iterator[Frame]:
    """Yield what one stream publishes."""
    times = kind.times(draw, seconds)
    for time, size in zip(times.tolist(), kind.draw_sizes(draw, len(times)).tolist(), strict=True):
        red = sum(amount for begin, end, amount in reds if begin <= time < end)
        yield Frame(f"r{robot}", f"r{robot}/{kind.name}", time, int(size), {"red": red} if kind.red else {})


def _message(stream: int, kind: Kind, frame: Frame, latency: float) -> Message:
    scale = kind.weight * (1.0 + 10.0 * frame.features.get("red", 0.0))
    return Message(stream, frame.t_gen, frame.t_gen, frame.t_gen + latency, kind.utility, scale, (float(frame.size),))


def _uniform(name: str, robots: int, seed: int, seconds: float, latency: float, *, everybody: bool) -> Mission:
    """Draw a mission of equal messages (§4.2), five per window; what robots tell each other comes on top of that."""
    # The robots of a team that broadcasts want everything, but there is an operator besides.
    how = conditions.Conditions(latency=latency, robots=robots, seconds=seconds - conditions.WARM_UP)
    drawn = missions.draw(scenario(name), seed, how)
    interests = _interests([f"r{robot}" for robot in range(robots)], everybody=everybody)
    problem = replace(drawn.problem, goes_on=False)
    inside = missions.draw(scenario(name), seed, replace(how, digests_inside=True)).specs
    window = conditions.WINDOW
    return Mission(problem, drawn.frames, drawn.specs, interests, inside, drawn.gross, drawn.carried, window)
