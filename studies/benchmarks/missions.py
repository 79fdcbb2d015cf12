"""Missions flown by contenders at points of a grid, on all cores, as shares of the offline bound."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from statistics import fmean
from time import perf_counter
from typing import Literal, TypeVar

from planner import Constraint, Problem, SearchSettings
from planner.constraints import violations
from planner.definition import utility
from studies.benchmarks.charts import Chart, Series
from studies.benchmarks.quality import RuleBrokenError
from studies.benchmarks.report import Table
from studies.central import Policy
from studies.mixed_workload import BYTE_LIMITS, mixed_mission
from studies.oracle import upper_bound
from studies.policies import Contender, Planned, Receding
from studies.processes import processes
from studies.workload import SCENARIOS, TWO_PER_HALF_SECOND, mission

LIMITS = (*(Constraint("messages", 2.5, float(limit)) for limit in (2, 5, 10, 16)), TWO_PER_HALF_SECOND)
"""So many messages per window of so many seconds."""

HORIZON = 60
ITERATIONS = 300
LATENCY = 0.01
"""Of every message where nothing else is said [s]."""

Place = TypeVar("Place")
Found = TypeVar("Found")

FUTURES = 6
"""Sampled futures among which best mode shares its iterations."""


@dataclass(frozen=True, slots=True)
class Point:
    """A point of the grid: by the places in LIMITS or BYTE_LIMITS and in SCENARIOS."""

    limit: int
    scenario: int
    workload: Literal["paper", "mixed"] = "paper"
    latency: float = LATENCY

    def limit_name(self) -> str:
        """Return the head of its row."""
        if self.workload == "mixed":
            share = BYTE_LIMITS[self.limit]
            return f"{100 * share.share:g} % of the bytes, per {share.window:g} s"
        return f"{LIMITS[self.limit].limit:g} per {LIMITS[self.limit].window:g} s"

    def mission(self, seed: int, seconds: float) -> Problem:
        """Draw one of its missions."""
        scenario = SCENARIOS[self.scenario]
        if self.workload == "mixed":
            limit = BYTE_LIMITS[self.limit]
            return mixed_mission(scenario, seed, seconds=seconds, latency=self.latency, limit=limit)
        return mission(scenario, seed, seconds=seconds, latency=self.latency, constraint=LIMITS[self.limit])


@dataclass(frozen=True, slots=True)
class Measured:
    """One mission of a point as a contender flew it: share of the bound, time of a decision [s], windows not proven."""

    point: Point
    contender: str
    share: float
    decision: float
    unproven: int


@dataclass(frozen=True, slots=True)
class _Task:
    point: Point
    seed: int
    seconds: float
    contenders: tuple[Contender, ...]


def points(workload: Literal["paper", "mixed"] = "paper", latency: float = LATENCY) -> list[Point]:
    """Return all points of a workload, row by row."""
    return [Point(limit, scenario, workload, latency) for limit, scenario in product(range(5), range(len(SCENARIOS)))]


def best_mode(iterations: int = ITERATIONS) -> Contender:
    """Return best mode as the daemon uses it: it plans for what is expected from periods and means."""
    return Contender(f"best mode, {iterations:,} iterations", partial(_planned, "best", iterations))


def best_mode_sampling() -> Contender:
    """Return best mode that shares its iterations among sampled futures; it knows how far messages deviate."""
    name = f"best mode, {ITERATIONS} iterations shared by {FUTURES} sampled futures"
    return Contender(name, partial(_planned, "best", ITERATIONS), futures=FUTURES)


def best_mode_knowing() -> Contender:
    """Return best mode with exact forecasts."""
    name = f"best mode, {ITERATIONS} iterations, exact forecasts"
    return Contender(name, partial(_planned, "best", ITERATIONS), forecast=False)


def paper_mode() -> Contender:
    """Return the search of the paper."""
    return Contender(f"paper mode, {ITERATIONS} iterations", partial(_planned, "paper", ITERATIONS))


def receding(*, beyond: bool) -> Contender:
    """Return the exact receding-horizon optimiser, of best mode's objective or of U of the window alone."""
    what = "best mode's objective" if beyond else "U of the window"
    return Contender(f"exact receding horizon, {what}", partial(_receding, beyond))


def _planned(search: Literal["best", "paper"], iterations: int, _mission: Problem) -> Policy:
    return Planned(SearchSettings(search=search), iterations)


def _receding(beyond: bool, _mission: Problem) -> Policy:  # noqa: FBT001 -- bound by position in a partial
    return Receding(beyond=beyond)


def fly_all(
    where: Sequence[Point], contenders: Sequence[Contender], *, seeds: int, seconds: float, alone: bool = False
) -> list[Measured]:
    """Fly `seeds` missions at every point with every contender, in as many processes as there are cores.

    `alone`: in this process. Raises RuleBrokenError when a lawful contender breaks a constraint, OracleUnavailable
    without SciPy.
    """
    tasks = [_Task(point, seed, seconds, tuple(contenders)) for point, seed in product(where, range(seeds))]
    return [one for flown in on_all_cores(_fly, tasks, alone=alone) for one in flown]


def on_all_cores(job: Callable[[Place], Found], places: Sequence[Place], *, alone: bool = False) -> list[Found]:
    """Do a job for every place, in as many processes as there are cores, or `alone` in this one."""
    if alone:
        return list(map(job, places))
    with processes() as pool:
        return list(pool.map(job, places))


def _fly(task: _Task) -> list[Measured]:
    flown = task.point.mission(task.seed, task.seconds)
    bound = upper_bound(flown).bound
    return [_measure(task, contender, flown, bound) for contender in task.contenders]


def _measure(task: _Task, contender: Contender, flown: Problem, bound: float) -> Measured:
    begin = perf_counter()
    sends, policy = contender.fly(flown, HORIZON)
    decision = (perf_counter() - begin) / len(flown.messages)
    broken = violations(flown, sends) if contender.lawful else []
    if broken:
        raise RuleBrokenError(f"{contender.name}, {SCENARIOS[task.point.scenario].name}: {broken[0]}")
    unproven = policy.unproven if isinstance(policy, Receding) else 0
    return Measured(task.point, contender.name, utility(flown, sends) / bound, decision, unproven)


def share_table(title: str, contender: str, measured: Iterable[Measured], note: str) -> Table:
    """Return one contender's shares: a row for each limit, a column for each scenario."""
    own = [one for one in measured if one.contender == contender]
    cells: dict[Point, list[float]] = {}
    for one in own:
        cells.setdefault(one.point, []).append(one.share)
    means = list(map(fmean, cells.values()))
    return Table(
        title,
        ("limit", *(scenario.name for scenario in SCENARIOS)),
        tuple(_rows(cells)),
        f"Share of the offline bound [%], the mean of a point, in brackets its worst mission. Mean of all points"
        f" {100 * fmean(means):.2f}, least point {100 * min(means):.2f}. {note}",
    )


def share_charts(
    title: str, contenders: Sequence[Contender], measured: Sequence[Measured], target: float
) -> list[Chart]:
    """Return a chart for each scenario: the mean shares of the contenders at every limit."""
    return [
        _share_chart(f"{title}, {scenario.name}", [c.name for c in contenders], of_scenario, target)
        for number, scenario in enumerate(SCENARIOS)
        if (of_scenario := [one for one in measured if one.point.scenario == number])
    ]


def _share_chart(title: str, names: Sequence[str], measured: Sequence[Measured], target: float) -> Chart:
    limits = list(dict.fromkeys(one.point.limit_name() for one in measured))
    shares: dict[tuple[str, str], list[float]] = {}
    for one in measured:
        shares.setdefault((one.contender, one.point.limit_name()), []).append(100 * one.share)
    series = tuple(Series(name, tuple(fmean(shares[name, limit]) for limit in limits)) for name in names)
    places = tuple(limit.replace(", ", "\n") for limit in limits)
    least = max(0.0, 10 * (min(map(fmean, shares.values())) // 10) - 10)
    return Chart(title, places, series, "share of the offline bound [%]", target=target, least=least)


def _rows(cells: dict[Point, list[float]]) -> Iterator[tuple[str, ...]]:
    for name in dict.fromkeys(point.limit_name() for point in cells):
        row = (shares for point, shares in cells.items() if point.limit_name() == name)
        yield name, *(f"{100 * fmean(shares):.2f} ({100 * min(shares):.2f})" for shares in row)
