"""What latency costs best mode: both workloads at 10 ms, 0.3 s and 1 s, each against the bound at its latency."""

from typing import Literal

from studies.benchmarks.missions import best_mode, fly_all, points, share_table
from studies.benchmarks.report import Table

LATENCIES = (0.01, 0.3, 1.0)
"""Of every message [s]."""

WORKLOADS: tuple[tuple[Literal["paper", "mixed"], str], ...] = (
    ("paper", "the paper's workload"),
    ("mixed", "mixed sizes"),
)


def measure_latency(*, quick: bool) -> list[Table]:
    """Fly both grids at every latency; return a table for each.

    `quick` flies one mission of 2 s at the tightest limit instead of three of 100 s.
    Raises OracleUnavailable without SciPy.
    """
    seeds, seconds = (1, 2.0) if quick else (3, 100.0)
    note = f"{seeds} missions of {seconds:g} s a point, horizon 60, one central decider. No constraint was broken."
    contender, tables = best_mode(), []
    for workload, name in WORKLOADS:
        for latency in LATENCIES:
            where = points(workload, latency)[: 3 if quick else None]
            measured = fly_all(where, (contender,), seeds=seeds, seconds=seconds, alone=quick)
            title = f"{contender.name}, {name}, latency {latency:g} s"
            tables.append(share_table(title, contender.name, measured, note))
    return tables
