"""Foresight: what forecasts are worth that know more of the future than a robot could, on the grid.

The study's forecasts know what was seen so far. They once took period, slope and deviations from the whole mission, so
this says what that was worth.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from statistics import fmean

from planner.constraints import violations
from planner.definition import utility
from studies.benchmarks.missions import HORIZON, ITERATIONS, Point, best_mode, on_all_cores, points
from studies.benchmarks.quality import RuleBrokenError
from studies.benchmarks.report import Table
from studies.oracle import upper_bound
from studies.policies import Contender
from studies.simulation.conditions import WARM_UP
from studies.simulation.scores import scored
from studies.study.results import Mean
from studies.workload import SCENARIOS

SEEN = "what was seen so far"


def forecasts() -> tuple[Contender, ...]:
    """Return best mode with each kind of forecast, those that know least first."""
    fresh = best_mode()
    return (
        replace(fresh, name=SEEN),
        replace(fresh, name="and what specs tell of streams to come", knowledge="specs"),
        replace(fresh, name="period, slope and jitter of the whole mission", knowledge="hindsight"),
        replace(fresh, name="the true times and messages", forecast=False),
    )


@dataclass(frozen=True, slots=True)
class Flight:
    """One mission as one kind of forecast let it be flown: shares of the bound, `settled` counted after the warm-up."""

    point: Point
    forecast: str
    share: float
    settled: float


def measure_foresight(*, quick: bool) -> list[Table]:
    """Fly the grid with every kind of forecast; return a table.

    `quick` flies one mission of 12 s at the tightest limit instead of two of 100 s. Raises OracleUnavailable without
    SciPy.
    """
    seeds, seconds = (1, 12.0) if quick else (2, 100.0)
    where = list(product(points()[: len(SCENARIOS) if quick else None], range(seeds)))
    flown = on_all_cores(partial(fly, seconds=seconds), where, alone=quick)
    return [_table([one for of_mission in flown for one in of_mission], seeds, seconds)]


def fly(place: tuple[Point, int], seconds: float) -> list[Flight]:
    """Fly the mission of a point and a seed with every kind of forecast.

    Raises RuleBrokenError when one breaks a constraint, OracleUnavailable without SciPy.
    """
    point, seed = place
    flown = point.mission(seed, seconds)
    later = scored(flown)
    bound, bound_later = upper_bound(flown).bound, upper_bound(later).bound
    found = []
    for contender in forecasts():
        sends, _ = contender.fly(flown, HORIZON)
        broken = violations(flown, sends)
        if broken:
            raise RuleBrokenError(f"{contender.name}, {SCENARIOS[point.scenario].name}: {broken[0]}")
        shares = utility(flown, sends) / bound, utility(later, sends) / bound_later
        found.append(Flight(point, contender.name, *shares))
    return found


def _table(flown: Sequence[Flight], seeds: int, seconds: float) -> Table:
    return Table(
        "Share of the offline bound, by what forecasts know",
        (
            "known",
            *(scenario.name for scenario in SCENARIOS),
            "mean",
            "least point",
            "more",
            f"mean after {WARM_UP:g} s",
            f"more after {WARM_UP:g} s",
        ),
        tuple(_rows(flown)),
        f"Best mode, {ITERATIONS} iterations, [%] and points, with the 95 % confidence interval of the mean over"
        f" missions: {seeds} of {seconds:g} s at each limit of the grid, latency 10 ms, horizon {HORIZON}, one central"
        f" decider. After {WARM_UP:g} s: what counts is the utility from then on, of the mission and of its bound. No"
        " constraint was broken.",
    )


def _rows(flown: Sequence[Flight]) -> Iterator[tuple[str, ...]]:
    first = [one for one in flown if one.forecast == SEEN]
    for contender in forecasts():
        own = [one for one in flown if one.forecast == contender.name]
        by_point = [fmean(one.share for one in own if one.point == at) for at in dict.fromkeys(o.point for o in own)]
        more = Mean.of([one.share - seen.share for one, seen in zip(own, first, strict=True)])
        more_later = Mean.of([one.settled - seen.settled for one, seen in zip(own, first, strict=True)])
        yield (
            contender.name,
            *(
                f"{100 * fmean(one.share for one in own if one.point.scenario == number):.2f}"
                for number in range(len(SCENARIOS))
            ),
            f"{100 * fmean(one.share for one in own):.2f}",
            f"{100 * min(by_point):.2f}",
            "–" if own == first else more.percent(2),
            f"{100 * fmean(one.settled for one in own):.2f}",
            "–" if own == first else more_later.percent(2),
        )
