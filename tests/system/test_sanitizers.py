"""The native tables and kernels run clean under AddressSanitizer and UndefinedBehaviorSanitizer."""

import subprocess
from dataclasses import replace
from itertools import accumulate, chain, cycle
from pathlib import Path

import pytest

from planner import (
    Aggregation,
    Custom,
    Exponential,
    Linear,
    Polynomial,
    Power,
    SearchSettings,
    Step,
    Table,
    Video,
    start,
)
from planner.tables import tabulate
from studies.central import CentralDecider
from studies.workload import SCENARIOS, mission
from tests.planner.windows import crowded
from tests.planner.windows import window as drawn

pytestmark = pytest.mark.system

ROOT = Path(__file__).parent.parent.parent
EVERY = 7
"""Of the windows of a mission every seventh is exported."""
SANITIZE = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer"]


@pytest.fixture(scope="module")
def kernel(tmp_path_factory):
    """The kernels as a standalone executable."""
    program = tmp_path_factory.mktemp("kernel") / "kernel"
    source = Path(__file__).parent / "kernel.cpp"
    include = f"-I{ROOT / 'planner' / 'native'}"
    flags = ["-std=c++20", "-O1", "-g", "-ffp-contract=off", *SANITIZE]
    subprocess.run(["g++", *flags, include, str(source), "-o", str(program)], check=True)
    return program


@pytest.fixture(scope="module")
def windows():
    """Windows of all scenarios as they come up in flight, and some of all aggregations side by side."""
    collected = []
    for seed, scenario in enumerate(SCENARIOS):
        decider = CentralDecider(mission(scenario, seed, seconds=12.0), horizon=40)

        def policy(window):
            collected.append(window)
            search = start(window, SearchSettings())
            search.run(50)
            return search.plan().send

        decider.fly(policy)
    mixed = [
        drawn(seed, robots=4, horizon=12, constraints=1 + seed % 3, aggregations=tuple(Aggregation))
        for seed in range(20)
    ]
    several = [replace(problem, messages=tuple(of_kinds(problem))) for problem in mixed]
    return [*collected[::EVERY], *mixed, *several, crowded(40)]


def of_kinds(problem):
    """Its messages with utilities of all kinds; those of `current` need one that is finite at first."""
    finite = (
        Linear(1.0, 0.3),
        Video(a1=3.0),
        Exponential(1.0, 0.5),
        Step(1.0, 0.7),
        Polynomial(1.0, 2.0, 3.0),
        Table(((0.0, 1.0), (1.0, 0.2))),
        Custom(lambda age, _: 1.0 / (1.0 + age)),
    )
    kinds, finite_kinds = cycle((*finite, Power(0.5))), cycle(finite)
    for message in problem.messages:
        is_current = problem.streams[message.stream].aggregation is Aggregation.CURRENT
        yield message._replace(utility=next(finite_kinds if is_current else kinds))


def test_plans_are_those_of_the_module_and_memory_is_clean(kernel, windows):
    """Both modes and all reductions, from roomy to tiny arenas: same plans, no finding."""
    budgets = ((300, 65_536), (300, 9))
    jobs = [(window, *budget, mode) for window in windows for budget in budgets for mode in ("paper", "best")]
    text = f"{len(jobs)}\n" + "\n".join(exported(*job) for job in jobs)
    done = subprocess.run([kernel], input=text, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    lines = iter(done.stdout.splitlines())
    for window, iterations, nodes, mode in jobs:
        for reduction in ("off", "paper", "exact") if mode == "paper" else ("off",):
            settings = SearchSettings(mode, "native", reduction, max_nodes=nodes)
            assert next(lines).split() == sends(window, settings, iterations)


def sends(window, settings, iterations):
    """The levels that the module plans to send, as the executable prints them."""
    search = start(window, settings)
    search.run(iterations)
    levels = {index: level for level, index in enumerate(tabulate(window).message)}
    return [str(levels[index]) for index in search.plan().sends]


def exported(window, iterations, nodes, mode):
    """A problem as the executable reads it."""
    receivers = [receiver for stream in window.streams for receiver in stream.receivers]
    starts = accumulate((len(stream.receivers) for stream in window.streams), initial=0)
    streams = [(stream.robot, list(Aggregation).index(stream.aggregation)) for stream in window.streams]
    newest = [(0, 0, 0) if s.newest is None else (1, *(value.hex() for value in s.newest)) for s in window.streams]
    utilities = list({id(m.utility): m.utility for m in window.messages}.values())
    place = {id(utility): number for number, utility in enumerate(utilities)}
    lines = [
        f"{window.current} {window.t_start.hex()} {window.t_end.hex()} {int(window.goes_on)}",
        table(
            (*stream, start, *latest)
            for stream, start, latest in zip([*streams, (0, 0)], starts, [*newest, (0, 0, 0)], strict=True)
        ),
        table((receiver.delay.hex(), receiver.share.hex()) for receiver in receivers),
        str(len(utilities)),
        *map(function, utilities),
        table(
            (m.stream, place[id(m.utility)], *(t.hex() for t in (m.t_gen, m.t_sent, m.t_rcv, m.scale)), int(m.sent))
            for m in window.messages
        ),
        table((constraint.window.hex(), constraint.limit.hex()) for constraint in window.constraints),
        reals(chain.from_iterable(m.use for m in window.messages)),
        reals(t.t_sent for t in window.traffic),
        reals(chain.from_iterable(t.use for t in window.traffic)),
        f"{iterations} {nodes} {mode}",
    ]
    return "\n".join(lines)


PARAMETERS = {
    Linear: ("u0", "slope"),
    Video: ("a0", "a1"),
    Exponential: ("u0", "tau"),
    Step: ("u0", "lifetime"),
    Polynomial: ("u0", "a1", "k"),
    Power: ("beta",),
    Table: (),
    Custom: ("until",),
}
"""Of each kind of utility, in the order in which the executable numbers them."""


def function(utility):
    """Kind, three parameters and points."""
    parameters = [getattr(utility, name) for name in PARAMETERS[type(utility)]]
    numbers = " ".join(float(parameter).hex() for parameter in (*parameters, 0.0, 0.0, 0.0)[:3])
    points = utility.curve.points.ravel() if hasattr(utility, "curve") else ()
    return f"{list(PARAMETERS).index(type(utility))} {numbers}\n{reals(points)}"


def table(entries):
    """A count, and that many entries."""
    lines = [" ".join(str(value) for value in entry) for entry in entries]
    return "\n".join([str(len(lines)), *lines])


def reals(values):
    """Numbers in hexadecimal, to the last bit."""
    return table((float(value).hex(),) for value in values)
