"""The workload of the paper's simulation study (§4.2): whole missions, known beforehand.

Ten robots publish one stream each at about 1 Hz; the utility of a message falls linearly from 1. Three scenarios
differ in how unequal the messages are. They are named by that, because their letters are swapped in the paper.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from planner import Constraint, Linear, Message, Problem, Stream

LEAST_SLOPE = 0.003
"""No message fades more slowly than this [1/s]."""

TWO_PER_HALF_SECOND = Constraint("messages", window=0.5, limit=2.0)
"""The constraint of the quality benchmark: at most two messages in any half second."""


@dataclass(frozen=True, slots=True)
class Scenario:
    """How unequal the messages are. `weight(i)` is that of all messages of robot i; the rest follows.

    `slope` and `slope_spread` are mean and standard deviation over robots [1/s], `message_spread` the deviation
    from message to message of one robot [1/s], `jitter` that of the generation times [s].
    """

    name: str
    slope: float
    slope_spread: float
    message_spread: float
    jitter: float
    weight: Callable[[int], float]


FEW_IMPORTANT = Scenario("few important", 0.2, 0.2, 0.001, 0.1, lambda i: 3.0 ** (i + 1))
MIXED = Scenario("mixed", 0.3, 0.01, 0.001, 0.001, lambda i: 1000.0 * i + 1)
MOST_IMPORTANT = Scenario("most important", 0.7, 0.0, 0.0, 0.0, lambda i: math.pow(i, 0.1) + 1)
SCENARIOS = (FEW_IMPORTANT, MIXED, MOST_IMPORTANT)


def mission(
    scenario: Scenario,
    seed: int,
    *,
    seconds: float = 100.0,
    robots: int = 10,
    latency: float = 0.01,
    constraint: Constraint = TWO_PER_HALF_SECOND,
) -> Problem:
    """Draw a mission: every message of all robots, open, as one problem; the same seed gives the same mission.

    More than ten robots repeat the ten weights, so that no weight leaves the range of the scenario.
    """
    draw = np.random.default_rng(seed)
    messages = [
        message
        for robot in range(robots)
        for message in _stream(scenario, robot, draw, seconds=seconds, latency=latency)
    ]
    messages.sort(key=lambda message: (message.t_gen, message.stream))
    streams = tuple(Stream(robot) for robot in range(robots))
    return Problem(streams, tuple(messages), 0, (constraint,), (), t_start=0.0, t_end=seconds)


def _stream(
    scenario: Scenario, robot: int, draw: np.random.Generator, *, seconds: float, latency: float
) -> list[Message]:
    times = generation_times(draw, scenario.jitter, seconds)
    slopes = message_slopes(draw, scenario, len(times))
    weight = scenario.weight(robot % 10)
    return [
        Message(robot, time, time, time + latency, Linear(1.0, fading), weight, (1.0,))
        for time, fading in zip(times.tolist(), slopes.tolist(), strict=True)
    ]


def message_slopes(draw: np.random.Generator, scenario: Scenario, count: int) -> npt.NDArray[np.float64]:
    """Return how fast the messages of one robot fade, around a slope of its own [1/s]."""
    slope = draw.normal(scenario.slope, scenario.slope_spread)
    return np.maximum(draw.normal(slope, scenario.message_spread, count), LEAST_SLOPE)


def generation_times(draw: np.random.Generator, jitter: float, seconds: float) -> npt.NDArray[np.float64]:
    """Return the generation times of one robot: periodic at N(1, 0.1) Hz from a random phase, with jitter."""
    period = 1.0 / draw.normal(1.0, 0.1)
    regular = np.arange(draw.uniform(0.0, period), seconds, period)
    jittered: npt.NDArray[np.float64] = np.sort(regular + draw.normal(0.0, jitter, len(regular)))
    return jittered[(jittered >= 0.0) & (jittered < seconds)]
