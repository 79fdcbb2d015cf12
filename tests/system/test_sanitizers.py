"""The native kernels run clean under AddressSanitizer and UndefinedBehaviorSanitizer."""

import subprocess
from pathlib import Path

import pytest

from planner import Aggregation, SearchSettings, start
from planner.tables import tabulate
from studies.central import CentralDecider
from studies.workload import SCENARIOS, mission
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
    return collected[::EVERY] + mixed


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
    levels = {index: level for level, index in enumerate(tabulate(window).message.tolist())}
    return [str(levels[index]) for index in search.plan().sends]


def exported(window, iterations, nodes, mode):
    """A tabulated problem as the executable reads it."""
    tables = tabulate(window, beyond=mode == "best")
    checks, gains = tables.checks, tables.gains
    columns = (gains.stream, gains.start, checks.start, checks.held, checks.never)
    end = (0, len(gains.aim), len(checks.room), tables.levels, 0)
    levels = [*list(zip(*(column[: tables.levels] for column in columns), strict=True)), end]
    rows = checks.rows
    lines = [
        f"{tables.levels} {tables.streams} {checks.use.shape[1]} {tables.current} {float(gains.aim_facts).hex()}",
        table((*(int(value) for value in level),) for level in levels),
        reals(gains.aim),
        table((int(state),) for state in gains.after),
        table((int(state),) for state in (0, *tables.states.cumsum())),
        table((int(flag),) for flag in gains.markovian),
        table(
            (int(of), int(first), float(room).hex())
            for of, first, room in zip(checks.of, checks.first, checks.room, strict=True)
        ),
        table(
            (int(of), int(first), int(last), float(capacity).hex())
            for of, first, last, capacity in zip(rows.of, rows.first, rows.last, rows.capacity, strict=True)
        ),
        reals(checks.use.ravel()),
        reals(checks.share.ravel()),
        reals(tables.scale),
        f"{iterations} {nodes} {mode}",
    ]
    return "\n".join(lines)


def table(entries):
    """A count, and that many entries."""
    lines = [" ".join(str(value) for value in entry) for entry in entries]
    return "\n".join([str(len(lines)), *lines])


def reals(values):
    """Numbers in hexadecimal, to the last bit."""
    return table((float(value).hex(),) for value in values)
