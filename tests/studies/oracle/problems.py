"""Small random problems, aggregations of a caller's own, and the optimum by trying everything."""

import random
from collections.abc import Hashable
from dataclasses import dataclass, replace
from itertools import chain, combinations

import numpy as np
from hypothesis import strategies as st

from planner import (
    Aggregation,
    AggregationModel,
    Constraint,
    Linear,
    Message,
    Problem,
    Receiver,
    Stream,
    Traffic,
    Video,
)
from planner.constraints import violations
from planner.definition import utility
from planner.received import Received
from studies.workload import MIXED, mission
from tests.planner.windows import window

TICK = 1 / 16
"""Times are multiples of this [s], so that messages lie exactly on the edges of windows."""

END = 4.0
SIZES = st.sampled_from([0.0, 1.0, 2.0, 3.0, 5.0])
LIMITS = st.sampled_from([1.0, 2.0, 3.0, 4.0])


@st.composite
def small_problems(draw: st.DrawFn) -> Problem:
    """At most nine messages of at most three streams; facts, traffic and oversized messages among them."""
    streams = draw(st.integers(1, 3))
    constraints = tuple(
        Constraint(f"c{k}", window=draw(st.sampled_from([0.25, 0.5, 1.0])), limit=draw(LIMITS))
        for k in range(draw(st.integers(1, 2)))
    )
    uses = st.tuples(*(SIZES for _ in constraints))
    latency = [draw(st.integers(0, 8)) * TICK for _ in range(streams)]
    times = sorted(draw(st.lists(st.integers(0, 48), min_size=1, max_size=9)))
    born = sorted((time * TICK, draw(st.integers(0, streams - 1))) for time in times)
    current = draw(st.integers(0, len(born) - 1))
    messages = tuple(
        Message(
            stream=stream,
            t_gen=t_gen,
            t_sent=t_gen,
            t_rcv=t_gen + latency[stream],
            utility=draw(st.sampled_from([Linear(1.0, 0.5), Linear(2.0, 4.0), Video(), Video(0.1, 0.9)])),
            scale=draw(st.sampled_from([0.0, 0.5, 1.0, 100.0])),
            use=draw(uses),
            sent=index != current and draw(st.sampled_from([False, False, False, True])),
        )
        for index, (t_gen, stream) in enumerate(born)
    )
    traffic = tuple(
        Traffic(draw(st.integers(-8, 48)) * TICK, draw(uses)) for _ in range(draw(st.sampled_from([0, 0, 1, 2])))
    )
    return Problem(tuple(map(Stream, range(streams))), messages, current, constraints, traffic, 0.0, END)


def best_by_trying(problem: Problem) -> float:
    """U of the best subset of the open messages that breaks no constraint."""
    opened = [index for index, message in enumerate(problem.messages) if not message.sent]
    subsets = chain.from_iterable(combinations(opened, count) for count in range(len(opened) + 1))
    return max(utility(problem, subset) for subset in subsets if not violations(problem, subset))


def one_stream(times: list[float], *, window: float, limit: float, sizes: list[float] | None = None) -> Problem:
    """Messages of one stream with a slowly fading utility, received at once."""
    uses = sizes or [1.0] * len(times)
    messages = tuple(
        Message(0, time, time, time, Linear(1.0, 0.125), 1.0, (use,)) for time, use in zip(times, uses, strict=True)
    )
    return Problem((Stream(0),), messages, 0, (Constraint("messages", window, limit),), (), 0.0, times[-1] + 1.0)


@dataclass(frozen=True)
class Pairs:
    """The two latest messages count, the older one half."""

    def empty(self) -> Hashable:
        return ()

    def add(self, state: tuple[float, ...], message: Message) -> Hashable:
        return (*state, message.scale)[-2:]

    def value(self, state: tuple[float, ...], t_end: float) -> float:  # noqa: ARG002 - it counts, whenever
        return sum(share * scale for share, scale in zip((1.0, 0.5), reversed(state), strict=False))


@dataclass(frozen=True)
class Annoyed:
    """The third message is one too many."""

    def empty(self) -> Hashable:
        return 0

    def add(self, state: int, message: Message) -> Hashable:  # noqa: ARG002 - any of them counts
        return state + 1

    def value(self, state: int, t_end: float) -> float:  # noqa: ARG002 - it counts, whenever
        return 2.0 * state - 0.45 * state**2


@dataclass(frozen=True)
class Hoard:
    """Every set of messages is a state of its own."""

    def empty(self) -> Hashable:
        return ()

    def add(self, state: tuple[float, ...], message: Message) -> Hashable:
        return (*state, message.t_gen)

    def value(self, state: tuple[float, ...], t_end: float) -> float:  # noqa: ARG002 - it counts, whenever
        return float(len(state))


KINDS: tuple[Aggregation | AggregationModel, ...] = (*Aggregation, Pairs(), Annoyed())


def mixed_window(seed: int) -> Problem:
    """A window of all aggregations with several receivers, of its own size and number of constraints by the seed."""
    return window(
        seed,
        robots=1 + seed % 5,
        horizon=4 + seed % 4,
        constraints=seed // 5 % 4,
        grid=seed % 3 == 0,
        aggregations=KINDS,
    )


def mixed_mission(seed: int, seconds: float = 20.0) -> Problem:
    """A mission of ten streams of all kinds, messages of unequal size and worth, and a limit on count and on bytes."""
    draw = random.Random(seed)
    flown = mission(MIXED, seed, seconds=seconds)
    sizes = [draw.choice((100.0, 400.0, 1500.0)) for _ in flown.messages]
    return replace(
        flown,
        streams=tuple(
            Stream(robot, KINDS[robot % len(KINDS)], (Receiver(), Receiver(0.2, 0.5)))
            for robot in range(len(flown.streams))
        ),
        messages=tuple(
            m._replace(use=(*m.use, size), scale=m.scale * draw.uniform(0.1, 2.0))
            for m, size in zip(flown.messages, sizes, strict=True)
        ),
        constraints=(*flown.constraints, Constraint("bytes", 1.0, 1200.0)),
    )


def of_kind(
    problem: Problem, aggregation: Aggregation | AggregationModel, *receivers: Receiver, streams: int = 1
) -> Problem:
    """The problem with streams of one kind; one receiver unless told."""
    return replace(problem, streams=tuple(Stream(at, aggregation, receivers or (Receiver(),)) for at in range(streams)))


def received(problem: Problem) -> Received:
    """All messages of a problem in the order of receipt."""
    opened = sum(not m.sent for m in problem.messages)
    return Received(problem, np.arange(len(problem.messages)), np.arange(opened))
