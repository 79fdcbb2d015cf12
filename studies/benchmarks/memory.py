"""Memory: what one search holds at most, and whether decisions leave anything behind."""

import gc
import os

import planner
from planner import Problem, Search, SearchSettings
from studies.benchmarks.report import Table
from studies.benchmarks.resources import private_memory
from studies.benchmarks.speed import Team
from studies.processes import processes

ITERATIONS = 10_000
MEGABYTE = 1_000_000
HELD = 20
"""Searches that are held at once, so that none lives in what another gave back."""

WARM = 2_000
"""Decisions after which the interpreter has all that it keeps."""

SETTINGS = (
    SearchSettings(search="best"),
    SearchSettings(search="paper"),
    SearchSettings(search="paper", reduction="paper"),
    SearchSettings(search="paper", reduction="exact"),
)


def measure_memory(*, quick: bool) -> list[Table]:
    """Measure and return both tables; `quick` makes hundreds of decisions instead of a million."""
    return [_searches(), _growth(500 if quick else 1_000_000)]


def resident() -> int:
    """Return the memory of this process that is in use [B]; raise OSError where the system does not tell."""
    gc.collect()
    return private_memory(os.getpid())


def _searches() -> Table:
    return Table(
        "A search of 10,000 iterations [MB]",
        ("search", "iterations", "nodes", "memory"),
        tuple(_in_a_process_of_its_own(settings) for settings in SETTINGS),
        "100 robots, horizon 120, the mean of searches held at once; the tables of the window are in it. Best mode ends"
        " when its answer is proven, any mode when its nodes are used up.",
    )


def _in_a_process_of_its_own(settings: SearchSettings) -> tuple[str, ...]:
    """Measure a search where no memory was given back before that it could live in."""
    with processes(1) as pool:
        return pool.submit(_held, settings).result()


def _held(settings: SearchSettings) -> tuple[str, ...]:
    window = Team(100, 120).windows(1)[0]
    _decide(window, settings, ITERATIONS)
    held: list[Search] = []
    before = resident()
    for _ in range(HELD):
        held.append(planner.start(window, settings))
        held[-1].run(ITERATIONS)
    each = (resident() - before) / HELD
    nodes = held[-1].plan().nodes
    return _name(settings), f"{held[-1].iterations:,}", f"{nodes:,}", f"{each / MEGABYTE:.1f}"


def _growth(decisions: int) -> Table:
    windows = Team(10, 12).windows(50)
    rows = []
    for settings in SETTINGS[:2]:
        grown = _grown(windows, settings, decisions)
        rows.append((_name(settings), f"{decisions:,}", f"{grown / MEGABYTE:+.2f}"))
    note = "Memory in use after so many decisions, less that after the first two thousand. Small windows."
    return Table("What decisions leave behind [MB]", ("search", "decisions", "grown"), tuple(rows), note)


def _grown(windows: list[Problem], settings: SearchSettings, decisions: int) -> int:
    for at in range(min(WARM, decisions)):
        _decide(windows[at % len(windows)], settings, 300)
    before = resident()
    for at in range(decisions):
        _decide(windows[at % len(windows)], settings, 300)
    return resident() - before


def _decide(window: Problem, settings: SearchSettings, iterations: int) -> None:
    search = planner.start(window, settings)
    search.run(iterations)
    search.plan()


def _name(settings: SearchSettings) -> str:
    reduction = f", reduction {settings.reduction}" if settings.reduction != "off" else ""
    return f"{settings.search}{reduction}"
