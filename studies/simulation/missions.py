"""Missions of the study as a team flies them: what apps publish, who wants it, and the specs for it."""

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import Literal

from planner import Constraint, Exponential, Linear, Message, MessageUtility, Polynomial, Problem, Step, Video
from studies.mixed_workload import ByteLimit, mixed_mission
from studies.simulation.conditions import WARM_UP, Conditions
from studies.simulation.records import Frame
from studies.workload import SCENARIOS, Scenario, mission
from utility_specs import Specs, load_specs

SIZE = 2_048
"""Of a message of the paper's workload [B]."""
SLACK = 0.25
"""There the limit carries so much more than whole messages: no plan gains by it, and nobody fails by a byte."""
GENERATED = 25.0
"""Messages that ten robots generate in a window."""
OPERATOR = "op"
"""Who wants everything in unicast."""

Sizes = Literal["equal", "mixed"]


@dataclass(frozen=True, slots=True)
class Mission:
    """A mission as the oracle and a central decider see it, and message by message the `frames` of a team.

    `carried` is what the limit leaves to messages per window, `gross` what it leaves to messages and digests [B].
    """

    problem: Problem
    frames: tuple[Frame, ...]
    specs: Specs
    interests: Mapping[str, tuple[str, ...]]
    carried: float
    gross: float


def draw(scenario: Scenario, seed: int, how: Conditions, sizes: Sizes = "equal") -> Mission:
    """Draw a mission: the paper's, or one of mixed sizes; the same seed gives the same one under all conditions."""
    seconds = WARM_UP + how.seconds
    if sizes == "equal":
        limit = Constraint("messages", how.window, float(how.limit))
        problem = mission(scenario, seed, seconds=seconds, robots=how.robots, latency=how.latency, constraint=limit)
        return of_equal(problem, how)
    share = ByteLimit(how.limit / GENERATED, how.window)
    problem = mixed_mission(scenario, seed, seconds=seconds, latency=how.latency, limit=share)
    return _mission(problem, [int(m.use[0]) for m in problem.messages], problem.constraints[0].limit, how)


def of_equal(problem: Problem, how: Conditions, throughput: str = "") -> Mission:
    """Return how a team flies a problem of messages of `SIZE` that are limited by their number.

    `throughput` stands in the specs instead of the limit in bytes that is as much.
    """
    limit = problem.constraints[0].limit
    carried = (limit + (SLACK if limit >= 1.0 else 0.0)) * SIZE
    return _mission(problem, [SIZE] * len(problem.messages), carried, how, throughput)


def _mission(problem: Problem, sizes: Sequence[int], carried: float, how: Conditions, throughput: str = "") -> Mission:
    keys = [f"r{stream.robot}/{number}" for number, stream in enumerate(problem.streams)]
    frames = tuple(
        Frame(keys[m.stream].split("/")[0], keys[m.stream], m.t_gen, size, {})
        for m, size in zip(problem.messages, sizes, strict=True)
    )
    gross = how.gross(carried)
    specs = specs_of(_spec(problem, keys, throughput or f'limit = "{gross / how.window!r} B/s"', how.window))
    return Mission(problem, frames, specs, _interests(how, frames), carried, gross)


def scenario(name: str) -> Scenario:
    """Return the scenario whose name begins so; raise `ValueError` when there is none."""
    for each in SCENARIOS:
        if each.name.startswith(name):
            return each
    raise ValueError(f"no scenario {name!r}: {', '.join(each.name for each in SCENARIOS)}")


def specs_of(text: str) -> Specs:
    """Load specs as a daemon would; raise `SpecsError` for what is wrong with them."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mission.toml"
        path.write_text(text)
        return load_specs(path)


def _interests(how: Conditions, frames: tuple[Frame, ...]) -> dict[str, tuple[str, ...]]:
    robots = sorted({frame.robot for frame in frames} | {f"r{i}" for i in range(how.robots)})
    if how.unicast:
        return dict.fromkeys(robots, ()) | {OPERATOR: ("*/*",)}
    return dict.fromkeys(robots, ("*/*",))


def _spec(problem: Problem, keys: list[str], throughput: str, window: float) -> str:
    """Return what an operator would write: of every stream the weight, and how its messages fade on average."""
    limit = f'[[constraint]]\nkind = "throughput"\n{throughput}\nwindow = {window}\n'
    streams = [[m for m in problem.messages if m.stream == number] for number in range(len(keys))]
    types = (
        _type(number, key, own, str(problem.streams[number].aggregation))
        for number, (key, own) in enumerate(zip(keys, streams, strict=True))
        if own
    )
    return "\n".join((limit, *types))


def _type(number: int, key: str, own: list[Message], aggregation: str) -> str:
    return (
        f'[[information_type]]\nname = "stream-{number}"\nkeys = ["{key}"]\naggregation = "{aggregation}"\n'
        f"weight = {own[0].scale!r}\nutility = {utility_table([m.utility for m in own])}\n"
    )


def utility_table(utilities: list[MessageUtility]) -> str:
    """Write the table of the mean utility as a spec has it; raise `TypeError` for a kind that no workload has."""
    first = utilities[0]
    match first:
        case Linear():
            return f'{{ kind = "linear", slope = {_mean(utilities, "slope")} }}'
        case Video():
            return f'{{ kind = "video", a1 = {_mean(utilities, "a1")} }}'
        case Exponential():
            return f'{{ kind = "exponential", tau = {_mean(utilities, "tau")} }}'
        case Step():
            return f'{{ kind = "step", lifetime = {_mean(utilities, "lifetime")} }}'
        case Polynomial():
            return f'{{ kind = "polynomial", a1 = {_mean(utilities, "a1")}, k = {first.k!r} }}'
    raise TypeError(f"no workload has {first!r}")


def _mean(utilities: list[MessageUtility], parameter: str) -> str:
    return repr(fmean(float(getattr(utility, parameter)) for utility in utilities))
