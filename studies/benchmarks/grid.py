"""The grid: what share of the offline bound a mission reaches, for limits from tight to loose."""

import os
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import product
from statistics import fmean

from planner import Constraint, SearchSettings
from planner.constraints import violations
from planner.definition import utility
from studies.benchmarks.quality import RuleBrokenError
from studies.benchmarks.report import Table
from studies.central import CentralDecider
from studies.oracle import upper_bound
from studies.policies import Planned
from studies.workload import SCENARIOS, TWO_PER_HALF_SECOND, mission

LIMITS = (*(Constraint("messages", 2.5, float(limit)) for limit in (2, 5, 10, 16)), TWO_PER_HALF_SECOND)
"""So many messages per window of so many seconds."""

HORIZON = 60
ITERATIONS = 300


@dataclass(frozen=True, slots=True)
class Flight:
    """How a mission is flown: by which search, with exact forecasts or with those from periods and means."""

    name: str
    settings: SearchSettings
    forecast: bool


FLIGHTS = (
    Flight("best mode, forecasts from periods and means", SearchSettings(search="best"), forecast=True),
    Flight("best mode, exact forecasts", SearchSettings(search="best"), forecast=False),
    Flight("paper mode, forecasts from periods and means", SearchSettings(search="paper"), forecast=True),
    Flight("paper mode, exact forecasts", SearchSettings(search="paper"), forecast=False),
)


@dataclass(frozen=True, slots=True)
class Mission:
    """One mission of the grid: a point of it by the places in LIMITS and SCENARIOS, and a seed."""

    limit: int
    scenario: int
    seed: int
    seconds: float


def measure_grid(*, quick: bool) -> list[Table]:
    """Fly all missions of the grid; return a table for each way to fly.

    `quick` flies one mission of 4 s a point instead of ten of 100 s. Raises OracleUnavailable without SciPy.
    """
    seeds, seconds = (1, 4.0) if quick else (10, 100.0)
    points = product(range(len(LIMITS)), range(len(SCENARIOS)), range(seeds))
    missions = [Mission(limit, scenario, seed, seconds) for limit, scenario, seed in points]
    if quick:
        shares = [fly(one) for one in missions]
    else:
        with ProcessPoolExecutor(os.cpu_count()) as pool:
            shares = list(pool.map(fly, missions))
    note = f"{seeds} missions of {seconds:g} s a point, {ITERATIONS} iterations, horizon {HORIZON}"
    return [_table(flight, missions, [share[at] for share in shares], note) for at, flight in enumerate(FLIGHTS)]


def fly(one: Mission) -> tuple[float, ...]:
    """Fly one mission in every way; return the shares of the bound. Raises RuleBrokenError when one breaks it."""
    scenario, limit = SCENARIOS[one.scenario], LIMITS[one.limit]
    flown = mission(scenario, one.seed, seconds=one.seconds, constraint=limit)
    bound = upper_bound(flown).bound
    shares = []
    for flight in FLIGHTS:
        policy = Planned(flight.settings, ITERATIONS)
        sends = CentralDecider(flown, HORIZON, forecast=flight.forecast).fly(policy)
        broken = violations(flown, sends)
        if broken:
            raise RuleBrokenError(f"{flight.name}, {scenario.name}: {broken[0]}")
        shares.append(utility(flown, sends) / bound)
    return tuple(shares)


def _table(flight: Flight, missions: list[Mission], shares: list[float], missions_note: str) -> Table:
    points = {
        (limit, scenario): [
            s for m, s in zip(missions, shares, strict=True) if (m.limit, m.scenario) == (limit, scenario)
        ]
        for limit, scenario in product(range(len(LIMITS)), range(len(SCENARIOS)))
    }
    least = min(map(fmean, points.values()))
    return Table(
        f"Share of the offline bound [%]: {flight.name}",
        ("limit", *(scenario.name for scenario in SCENARIOS)),
        tuple(_rows(points)),
        f"The mean of a point, in brackets its worst mission. Mean of all points {100 * fmean(shares):.2f}, least"
        f" point {100 * least:.2f}. {missions_note}, latency 10 ms, one central decider. No constraint was broken.",
    )


def _rows(points: dict[tuple[int, int], list[float]]) -> Iterator[tuple[str, ...]]:
    for at, limit in enumerate(LIMITS):
        cells = (points[at, scenario] for scenario in range(len(SCENARIOS)))
        shown = (f"{100 * fmean(cell):.2f} ({100 * min(cell):.2f})" for cell in cells)
        yield f"{limit.limit:g} per {limit.window:g} s", *shown
