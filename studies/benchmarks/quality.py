"""Quality: how much utility policies lose against the offline optimum, on 30 s missions."""

from collections.abc import Iterator
from dataclasses import dataclass
from statistics import fmean

from planner import Problem, SearchSettings
from planner.constraints import violations
from planner.definition import utility
from studies.benchmarks.report import Table
from studies.central import CentralDecider, Policy
from studies.oracle import optimum, upper_bound
from studies.policies import Planned, by_rank, whenever_it_fits
from studies.workload import SCENARIOS, Scenario, mission

PATIENCE = 60.0
"""What an integer programme may take [s]; where the time is up, the best plan found so far stands in."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """A policy with the horizon of its windows [messages]."""

    name: str
    policy: Policy
    horizon: int


@dataclass(frozen=True, slots=True)
class Measured:
    """What one candidate reached on one mission, beside the oracle's figures [utility·s]."""

    candidate: str
    scenario: str
    reached: float
    optimum: float
    bound: float
    proven: bool


class RuleBrokenError(Exception):
    """A policy sent what a constraint forbids: its utility means nothing."""


def candidates() -> Iterator[Candidate]:
    """Return what is compared: two simple policies, then both searches with two budgets and two horizons."""
    yield Candidate("whenever it fits", whenever_it_fits, 30)
    yield Candidate("by rank of marginal utility", by_rank, 30)
    for horizon in (30, 60):
        for iterations in (300, 1500):
            paper = Planned(SearchSettings(search="paper"), iterations)
            yield Candidate(f"paper, {iterations:,} iterations, horizon {horizon}", paper, horizon)
        for iterations in (300, 1500):
            best = Planned(SearchSettings(search="best"), iterations)
            yield Candidate(f"best, {iterations:,} iterations, horizon {horizon}", best, horizon)


def measure_quality(*, quick: bool) -> list[Table]:
    """Fly all missions with all candidates and return the table of losses.

    `quick` flies one mission of 5 s a scenario instead of five of 30 s. Raises OracleUnavailable without SciPy.
    """
    seeds, seconds = (1, 5.0) if quick else (5, 30.0)
    measured = [
        one
        for scenario in SCENARIOS
        for seed in range(seeds)
        for one in measure_mission(scenario, mission(scenario, seed, seconds=seconds))
    ]
    return [_losses(measured, f"{len(SCENARIOS)} scenarios × {seeds} missions of {seconds:g} s")]


def measure_mission(scenario: Scenario, flown: Problem) -> Iterator[Measured]:
    """Fly one mission with all candidates; raise RuleBrokenError when one breaks a constraint."""
    bound, best = upper_bound(flown), optimum(flown, PATIENCE)
    for candidate in candidates():
        sends = CentralDecider(flown, candidate.horizon).fly(candidate.policy)
        broken = violations(flown, sends)
        if broken:
            raise RuleBrokenError(f"{candidate.name}, {scenario.name}: {broken[0]}")
        reached = utility(flown, sends)
        yield Measured(candidate.name, scenario.name, reached, best.utility, bound.bound, best.exact)


def _losses(measured: list[Measured], missions: str) -> Table:
    rows = []
    for name in dict.fromkeys(one.candidate for one in measured):
        own = [one for one in measured if one.candidate == name]
        each = [fmean(_lost(one) for one in own if one.scenario == scenario.name) for scenario in SCENARIOS]
        worst = max(map(_lost, own))
        against_bound = fmean(1 - one.reached / one.bound for one in own)
        rows.append((name, *(f"{100 * loss:.2f}" for loss in (*each, fmean(each), worst, against_bound))))
    flown = {(one.scenario, one.optimum): one.proven for one in measured}
    return Table(
        "Utility lost against the integer optimum [%]",
        ("policy", *(scenario.name for scenario in SCENARIOS), "mean", "worst mission", "mean against LP bound"),
        tuple(rows),
        f"{missions}, 2 messages per 0.5 s, latency 10 ms, exact forecast, one central decider. The integer optimum"
        f" is proven for {sum(flown.values())} of {len(flown)}. No constraint was broken.",
    )


def _lost(one: Measured) -> float:
    return 1 - one.reached / one.optimum
