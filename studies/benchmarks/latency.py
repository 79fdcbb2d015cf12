"""What latency costs best mode: both workloads at 10 ms, 0.3 s and 1 s, each against the bound at its latency."""

from collections.abc import Mapping, Sequence
from statistics import fmean
from typing import Literal

from studies.benchmarks.charts import Chart, Series
from studies.benchmarks.missions import Measured, best_mode, fly_all, points, share_table
from studies.benchmarks.report import Table
from studies.workload import SCENARIOS

LATENCIES = (0.01, 0.3, 1.0)
"""Of every message [s]."""

WORKLOADS: tuple[tuple[Literal["paper", "mixed"], str], ...] = (
    ("paper", "the paper's workload"),
    ("mixed", "mixed sizes"),
)


def measure_latency(*, quick: bool) -> list[Table | Chart]:
    """Fly both grids at every latency; return a chart, and a table for each.

    `quick` flies one mission of 2 s at the tightest limit instead of two of 100 s.
    Raises OracleUnavailable without SciPy.
    """
    seeds, seconds = (1, 2.0) if quick else (2, 100.0)
    note = f"{seeds} missions of {seconds:g} s a point, horizon 60, one central decider. No constraint was broken."
    measured = {
        workload: [
            fly_all(
                points(workload, latency)[: 3 if quick else None],
                (best_mode(),),
                seeds=seeds,
                seconds=seconds,
                alone=quick,
            )
            for latency in LATENCIES
        ]
        for workload, _ in WORKLOADS
    }
    tables = [
        share_table(f"{best_mode().name}, {name}, latency {latency:g} s", best_mode().name, flown, note)
        for workload, name in WORKLOADS
        for latency, flown in zip(LATENCIES, measured[workload], strict=True)
    ]
    return [_chart(measured), *tables]


def _chart(measured: Mapping[Literal["paper", "mixed"], Sequence[Sequence[Measured]]]) -> Chart:
    """Draw the mean over all limits against the latency, scenario by scenario."""
    series = tuple(
        Series(f"{name}, {scenario.name}", tuple(_mean(flown, number) for flown in measured[workload]))
        for workload, name in WORKLOADS
        for number, scenario in enumerate(SCENARIOS)
    )
    places = tuple(f"{latency:g} s" for latency in LATENCIES)
    least = 5 * (min(value for one in series for value in one.values if value is not None) // 5)
    return Chart("Share of the bound at the same latency", places, series, "[%]", "lines", least=least)


def _mean(flown: Sequence[Measured], scenario: int) -> float:
    return 100 * fmean(one.share for one in flown if one.point.scenario == scenario)
