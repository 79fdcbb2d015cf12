"""Tables: how long it takes to tabulate a window, in C++ and with NumPy."""

import random
from collections.abc import Callable, Iterator
from itertools import cycle, islice
from statistics import fmean
from time import perf_counter

import numpy as np

from planner import (
    Aggregation,
    Constraint,
    Exponential,
    Linear,
    Message,
    Polynomial,
    Power,
    Problem,
    Receiver,
    Step,
    Stream,
    Traffic,
    Video,
)
from planner import Table as DrawnByHand
from planner.numpy_tables import tabulate_with_numpy
from planner.tables import Tables, tabulate
from planner.utility import MessageUtility
from studies.benchmarks.report import Table
from studies.central import CentralDecider
from studies.mixed_workload import mixed_mission
from studies.policies import whenever_it_fits
from studies.workload import SCENARIOS

UTILITIES: tuple[MessageUtility, ...] = (
    Linear(1.0, 0.4),
    Video(a1=5.0),
    Exponential(1.0, 2.0),
    Step(1.0, 1.5),
    Polynomial(1.0, 3.0),
    Power(0.5),
    DrawnByHand(((0.0, 1.0), (1.0, 0.5), (3.0, 0.0))),
)
"""What the streams of a window of all kinds carry in turn."""

Tabulate = Callable[[Problem], Tables]


def measure_tables(same: list[Problem], repetitions: int) -> Table:
    """Time windows of one kind, windows of several kinds of utility, and windows of all kinds."""
    count = len(same)
    windows = (
        ("one kind, 10 streams", same),
        ("five utilities, 10 streams", _mixed(count)),
        ("seven utilities, no `best`, 20 streams", [of_all_kinds(seed, 20, 4, _WITHOUT_BEST) for seed in range(count)]),
        ("all kinds, 20 streams", [of_all_kinds(seed, 20, 4, tuple(Aggregation)) for seed in range(count)]),
        ("all kinds, 40 streams", [of_all_kinds(seed, 40, 3, tuple(Aggregation)) for seed in range(count)]),
    )
    return Table(
        "Tabulating a window [ms]",
        ("window", "messages", "C++, p50", "C++, p99", "NumPy, p50"),
        tuple(_row(name, problems, repetitions) for name, problems in windows),
        "From the Python objects of a window to the tables that a search begins with, its validation included.",
    )


_WITHOUT_BEST = (Aggregation.MOST_RECENT, Aggregation.SUM, Aggregation.ONCE)


def _row(name: str, problems: list[Problem], repetitions: int) -> tuple[str, ...]:
    native = _times(problems, repetitions, lambda problem: tabulate(problem, beyond=True))
    numpy = _times(problems, 1, lambda problem: tabulate_with_numpy(problem, beyond=True))
    cells = (np.median(native), np.quantile(native, 0.99), np.median(numpy))
    return name, f"{fmean(len(p.messages) for p in problems):.0f}", *(f"{1e3 * cell:.3f}" for cell in cells)


def _times(problems: list[Problem], repetitions: int, tables: Tabulate) -> list[float]:
    times = []
    for problem in problems * repetitions:
        begin = perf_counter()
        tables(problem)
        times.append(perf_counter() - begin)
    return times


def _mixed(count: int) -> list[Problem]:
    """Return windows from the midst of a mission of messages of 0.2 to 50 kB, flown by sending whatever fits."""
    decider, windows = CentralDecider(mixed_mission(SCENARIOS[0], 1, seconds=30.0), 60), []
    for index in range(100 + count):
        window = decider.window(index)
        if whenever_it_fits(window):
            decider.send(index)
        windows.append(window)
    return windows[-count:]


def of_all_kinds(seed: int, streams: int, each: int, aggregations: tuple[Aggregation, ...]) -> Problem:
    """Draw a window of `streams` with `each` so many messages to decide, two limits, one to three receivers."""
    draw = random.Random(seed)
    kinds = tuple(
        Stream(at % 8, _fitting(draw.choice(aggregations), utility), _receivers(draw))
        for at, utility in zip(range(streams), cycle(UTILITIES), strict=False)
    )
    messages = [
        message
        for at, utility in zip(range(streams), cycle(UTILITIES), strict=False)
        for message in islice(_stream(draw, at, utility), each)
    ]
    facts = [
        _message(draw, at, -draw.uniform(0.0, 2.0), UTILITIES[at % len(UTILITIES)], sent=True)
        for at in range(0, streams, 2)
    ]
    ordered = sorted([*messages, *facts], key=lambda m: (m.t_gen, kinds[m.stream].robot, m.stream))
    return Problem(
        kinds,
        tuple(ordered),
        len(facts),
        (Constraint("throughput", 1.0, 200e3), Constraint("messages", 1.0, 5.0)),
        tuple(Traffic(-draw.uniform(0.0, 1.0), (1e3, 0.1)) for _ in range(10)),
        t_start=-10.0,
        t_end=ordered[-1].t_rcv + 1.0,
    )


def _fitting(aggregation: Aggregation, utility: MessageUtility) -> Aggregation:
    """Return an aggregation, but for `current`, which needs a utility that is finite at the age 0."""
    lacks = aggregation is Aggregation.CURRENT and isinstance(utility, Power)
    return Aggregation.MOST_RECENT if lacks else aggregation


def _receivers(draw: random.Random) -> tuple[Receiver, ...]:
    return tuple(Receiver(draw.choice((0.0, 0.02, 0.1)), 1.0) for _ in range(draw.randint(1, 3)))


def _stream(draw: random.Random, stream: int, utility: MessageUtility) -> Iterator[Message]:
    """Yield the messages of a stream with a period of its own."""
    period = draw.uniform(0.5, 2.0)
    t_gen = draw.uniform(0.0, period)
    while True:
        yield _message(draw, stream, t_gen, utility)
        t_gen += period


def _message(draw: random.Random, stream: int, t_gen: float, utility: MessageUtility, *, sent: bool = False) -> Message:
    uses = (draw.uniform(200.0, 50e3), 1.0)
    return Message(stream, t_gen, t_gen, t_gen + 0.02, utility, draw.uniform(0.5, 5.0), uses, sent)
