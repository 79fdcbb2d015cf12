"""Speed: how many iterations a second a search makes, and how long a whole decision takes from Python."""

from dataclasses import dataclass
from itertools import pairwise
from time import perf_counter
from typing import Literal

import numpy as np

import planner
from planner import Constraint, Problem, SearchSettings
from studies.benchmarks.report import Table
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


TEAMS = (Team(10, 30), Team(10, 60), Team(100, 120))


def measure_speed(*, quick: bool) -> list[Table]:
    """Measure and return both tables; `quick` takes a second instead of a minute, with rougher figures."""
    return [_search_alone(3 if quick else 20, TEAMS[:1] if quick else TEAMS), _decisions(3.0 if quick else 60.0)]


def _search_alone(count: int, teams: tuple[Team, ...]) -> Table:
    rows = []
    windows = {team: team.windows(count) for team in teams}
    for engine, mode in ((engine, mode) for engine in _ENGINES for mode in BUDGET):
        settings = SearchSettings(search=mode, engine=engine)
        # The Python engine is there to be read: a few windows say enough.
        few = count if engine == "native" else 3
        rates = [_rate(windows[team][:few], settings, BUDGET[mode]) for team in teams]
        rows.append((f"{mode}, {engine}", *(f"{rate:,.0f} ({done:,.0f})" for rate, done in rates)))
    return Table(
        "Search alone [iterations/s]",
        ("search, engine", *(team.name() for team in teams)),
        tuple(rows),
        f"In brackets the mean number of iterations done: the budget is {BUDGET['paper']:,} in paper mode and"
        f" {BUDGET['best']:,} in best mode, which ends earlier when the answer cannot change any more. {count} windows."
        " Tabulating a window is not in it.",
    )


_ENGINES: tuple[Engine, ...] = ("native", "python")


def _rate(windows: list[Problem], settings: SearchSettings, budget: int) -> tuple[float, float]:
    """Return iterations a second and iterations a window of running searches on all windows, three times each."""
    iterations, spent = 0, 0.0
    for window in windows * 3:
        search = planner.start(window, settings, seed=0)
        begin = perf_counter()
        iterations += search.run(budget)
        spent += perf_counter() - begin
    return iterations / spent, iterations / (3 * len(windows))


def _decisions(seconds: float) -> Table:
    rows = []
    for engine, mode in ((engine, mode) for engine in _ENGINES for mode in BUDGET):
        team = TEAMS[0]
        flown = team.mission(seconds if engine == "native" else min(seconds, 3.0))
        parts = _fly_timed(flown, team.horizon, SearchSettings(search=mode, engine=engine), BUDGET[mode]) * 1e3
        whole = parts.sum(axis=1)
        shown = (*np.median(parts, axis=0), np.median(whole), np.quantile(whole, 0.99), whole.max())
        rows.append((f"{mode}, {BUDGET[mode]:,}, {engine}", f"{len(whole)}", *(f"{cell:.3f}" for cell in shown)))
    head = ("search, iterations, engine", "decisions", "window", "start", "run", "plan", "p50", "p99", "max")
    note = "Median of each part; p50, p99 and max of the whole. The window is built from the mission's messages."
    return Table(f"A decision from Python, {TEAMS[0].name()} [ms]", head, tuple(rows), note)


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
