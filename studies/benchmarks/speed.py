"""Speed: how many iterations a second a search makes, and how long a whole decision takes from Python."""

from dataclasses import dataclass
from itertools import pairwise
from time import perf_counter
from typing import Literal

import numpy as np

import planner
from planner import Constraint, Problem, SearchSettings
from studies.benchmarks.charts import Chart, Series
from studies.benchmarks.report import Table
from studies.benchmarks.tables import measure_tables
from studies.central import CentralDecider
from studies.policies import whenever_it_fits
from studies.workload import MOST_IMPORTANT, mission

Mode = Literal["paper", "best"]
Engine = Literal["native", "python"]

BUDGET: dict[Mode, int] = {"paper": 1500, "best": 300}
"""Iterations of a decision."""


@dataclass(frozen=True, slots=True)
class Team:
    """So many robots at 1 Hz with windows of `horizon` messages; room for two fifths of what they generate.

    The scenario is the one whose messages are most alike: there the best search needs the most iterations.
    """

    robots: int
    horizon: int

    def name(self) -> str:
        """Return the head of its column."""
        return f"{self.robots} robots, horizon {self.horizon}"

    def mission(self, seconds: float) -> Problem:
        """Draw its mission."""
        limit = Constraint("messages", window=0.5, limit=self.robots / 5)
        return mission(MOST_IMPORTANT, seed=1, seconds=seconds, robots=self.robots, constraint=limit)

    def windows(self, count: int) -> list[Problem]:
        """Return windows from the middle of a mission that was flown so far by sending whatever fits."""
        decider = CentralDecider(self.mission(30.0), self.horizon)
        windows = []
        for index in range(15 * self.robots):
            window = decider.window(index)
            if whenever_it_fits(window):
                decider.send(index)
                windows.append(window)
        return windows[-count:]


TEAMS = (Team(10, 30), Team(100, 30), Team(10, 60), Team(100, 60))


def measure_speed(*, quick: bool) -> list[Table | Chart]:
    """Measure and return tables and a chart; `quick` takes a second instead of a minute, with rougher figures."""
    teams = TEAMS[:2] if quick else TEAMS
    rates = _rates(3 if quick else 40, teams)
    return [
        _search_alone(rates, teams),
        _rates_chart(rates, teams),
        _ratios(rates, teams),
        measure_tables(TEAMS[2].windows(5 if quick else 40), 3 if quick else 25),
        _decisions(TEAMS[0], 3.0 if quick else 60.0, _ENGINES),
        _decisions(TEAMS[2], 3.0 if quick else 60.0, ("native",)),
    ]


@dataclass(frozen=True, slots=True)
class Rate:
    """How fast one search runs: iterations a second, and how many it does of its budget in the mean."""

    per_second: float
    done: float


Rates = dict[tuple[Engine, Mode, Team], Rate]


def _rates(count: int, teams: tuple[Team, ...]) -> Rates:
    windows = {team: team.windows(count) for team in teams}
    # The Python engine is there to be read: a few windows say enough.
    few = {"native": count, "python": 3}
    return {
        (engine, mode, team): _rate(windows[team][: few[engine]], SearchSettings(mode, engine), BUDGET[mode])
        for engine in _ENGINES
        for mode in BUDGET
        for team in teams
    }


def _search_alone(rates: Rates, teams: tuple[Team, ...]) -> Table:
    rows = []
    for engine, mode in ((engine, mode) for engine in _ENGINES for mode in BUDGET):
        cells = (rates[engine, mode, team] for team in teams)
        rows.append((f"{mode}, {engine}", *(f"{rate.per_second:,.0f} ({rate.done:,.0f})" for rate in cells)))
    return Table(
        "Search alone [iterations/s]",
        ("search, engine", *(team.name() for team in teams)),
        tuple(rows),
        f"In brackets the mean number of iterations done: the budget is {BUDGET['paper']:,} in paper mode and"
        f" {BUDGET['best']:,} in best mode, which ends earlier when the answer cannot change any more. An iteration of"
        " best mode is a round of learning, a level of the sweep or a leaf of the tree. Tabulating a window is not in"
        " it.",
    )


def _rates_chart(rates: Rates, teams: tuple[Team, ...]) -> Chart:
    series = tuple(
        Series(f"{mode}, {engine}", tuple(rates[engine, mode, team].per_second for team in teams))
        for engine in _ENGINES
        for mode in BUDGET
    )
    places = tuple(team.name().replace(", ", "\n") for team in teams)
    return Chart("Search alone", places, series, "iterations / s", least=1e2, logarithmic=True)


def _ratios(rates: Rates, teams: tuple[Team, ...]) -> Table:
    rows: list[tuple[str, ...]] = []
    for mode in BUDGET:
        gains = (rates["native", mode, team].per_second / rates["python", mode, team].per_second for team in teams)
        rows.append((f"{mode}: native engine to Python engine", *(f"{gain:.0f}" for gain in gains)))
    for mode in BUDGET:
        few = {team.horizon: rates["native", mode, team].per_second for team in teams if team.robots == 10}
        shares = (
            "" if t.robots == 10 else f"{rates['native', mode, t].per_second / few[t.horizon]:.2f}" for t in teams
        )
        rows.append((f"{mode}: 100 robots to 10", *shares))
    return Table("Ratios of these rates", ("ratio", *(team.name() for team in teams)), tuple(rows))


_ENGINES: tuple[Engine, ...] = ("native", "python")


def _rate(windows: list[Problem], settings: SearchSettings, budget: int) -> Rate:
    """Run searches on all windows, three times each."""
    iterations, spent = 0, 0.0
    for window in windows * 3:
        search = planner.start(window, settings, seed=0)
        begin = perf_counter()
        iterations += search.run(budget)
        spent += perf_counter() - begin
    return Rate(iterations / spent, iterations / (3 * len(windows)))


def _decisions(team: Team, seconds: float, engines: tuple[Engine, ...]) -> Table:
    rows = []
    for engine, mode in ((engine, mode) for engine in engines for mode in BUDGET):
        flown = team.mission(seconds if engine == "native" else min(seconds, 3.0))
        parts = _fly_timed(flown, team.horizon, SearchSettings(search=mode, engine=engine), BUDGET[mode]) * 1e3
        whole = parts.sum(axis=1)
        shown = (*np.median(parts, axis=0), np.median(whole), np.quantile(whole, 0.99), whole.max())
        rows.append((f"{mode}, {BUDGET[mode]:,}, {engine}", f"{len(whole)}", *(f"{cell:.3f}" for cell in shown)))
    head = ("search, iterations, engine", "decisions", "window", "start", "run", "plan", "p50", "p99", "max")
    note = "Median of each part; p50, p99 and max of the whole. The window is built from the mission's messages."
    return Table(f"A decision from Python, {team.name()} [ms]", head, tuple(rows), note)


def _fly_timed(flown: Problem, horizon: int, settings: SearchSettings, budget: int) -> np.ndarray[tuple[int, int]]:
    """Fly a mission; return the times [s] for window, start, run and plan of each decision."""
    decider = CentralDecider(flown, horizon)
    times = []
    for index in range(len(flown.messages)):
        clock = [perf_counter()]
        window = decider.window(index)
        clock.append(perf_counter())
        search = planner.start(window, settings, seed=index)
        clock.append(perf_counter())
        search.run(budget)
        clock.append(perf_counter())
        plan = search.plan()
        clock.append(perf_counter())
        times.append([after - before for before, after in pairwise(clock)])
        if plan.send:
            decider.send(index)
    return np.array(times)
