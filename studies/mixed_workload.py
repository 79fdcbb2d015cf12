"""A harder workload than the paper's: robots with streams of several kinds, messages of 0.2 to 50 kB, limits in bytes.

Rates, weights and what makes messages unequal are those of the scenarios of §4.2; instead of one stream of messages of
one size each robot has two or three, whose sizes span more than two decades. So a limit that carries a tenth of the
bytes may be less than a single message.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from planner import Constraint, Exponential, Linear, Message, Polynomial, Problem, Step, Stream, Video
from planner.utility import MessageUtility
from studies.workload import Scenario, generation_times, message_slopes

ROBOTS = (0, 0, 0, 1, 1, 2, 2, 2, 3, 3)
"""The robot of each of the ten streams."""

LEAST_SIZE, GREATEST_SIZE = 200.0, 50_000.0
"""Of all messages [B]; streams lie log-uniformly in between."""

SIZE_SPREAD = 0.2
"""Standard deviation of the logarithm of a message's size around that of its stream."""

SHARES = (0.08, 0.2, 0.4, 0.64)
"""What part of all bytes fits: as 2, 5, 10 and 16 of 25 messages in 2.5 s."""


def _linear(slope: float) -> MessageUtility:
    return Linear(1.0, slope)


def _video(slope: float) -> MessageUtility:
    return Video(a0=1 / 30, a1=2.0 / slope)


def _exponential(slope: float) -> MessageUtility:
    return Exponential(1.0, 1.0 / slope)


def _step(slope: float) -> MessageUtility:
    return Step(1.0, 1.0 / slope)


def _polynomial(slope: float) -> MessageUtility:
    return Polynomial(1.0, 1.5 / slope, 2.0)


KINDS: tuple[Callable[[float], MessageUtility], ...] = (_linear, _video, _exponential, _step, _polynomial)
"""What the streams carry in turn, by the slope that the scenario draws [1/s]."""


@dataclass(frozen=True, slots=True)
class ByteLimit:
    """A throughput limit that carries `share` of what a mission generates, in windows of `window` [s]."""

    share: float
    window: float

    def constraint(self, generated: float) -> Constraint:
        """Return the constraint for `generated` bytes per second."""
        return Constraint("throughput", self.window, self.share * generated * self.window)


BYTE_LIMITS = (*(ByteLimit(share, 2.5) for share in SHARES), ByteLimit(0.4, 0.5))


def mixed_mission(
    scenario: Scenario,
    seed: int,
    *,
    seconds: float = 100.0,
    latency: float = 0.01,
    limit: ByteLimit = BYTE_LIMITS[-1],
) -> Problem:
    """Draw a mission: every message of all streams, open, as one problem; the same seed gives the same mission."""
    draw = np.random.default_rng(seed)
    messages = [
        message
        for stream in range(len(ROBOTS))
        for message in _stream(scenario, stream, draw, seconds=seconds, latency=latency)
    ]
    messages.sort(key=lambda message: (message.t_gen, ROBOTS[message.stream], message.stream))
    constraint = limit.constraint(sum(message.use[0] for message in messages) / seconds)
    streams = tuple(Stream(robot) for robot in ROBOTS)
    return Problem(streams, tuple(messages), 0, (constraint,), (), t_start=0.0, t_end=seconds)


def _stream(
    scenario: Scenario, stream: int, draw: np.random.Generator, *, seconds: float, latency: float
) -> list[Message]:
    times = generation_times(draw, scenario.jitter, seconds)
    slopes = message_slopes(draw, scenario, len(times))
    typical = draw.uniform(np.log(LEAST_SIZE), np.log(GREATEST_SIZE))
    sizes = np.clip(np.exp(draw.normal(typical, SIZE_SPREAD, len(times))), LEAST_SIZE, GREATEST_SIZE)
    weight, kind = scenario.weight(stream), KINDS[stream % len(KINDS)]
    return [
        Message(stream, time, time, time + latency, kind(fading), weight, (size,))
        for time, fading, size in zip(times.tolist(), slopes.tolist(), sizes.round().tolist(), strict=True)
    ]
