"""The grid on the mixed workload: several kinds of streams per robot, 0.2 to 50 kB, limits in bytes."""

from studies.benchmarks.missions import (
    best_mode,
    best_mode_expecting,
    best_mode_knowing,
    fly_all,
    paper_mode,
    points,
    share_table,
)
from studies.benchmarks.report import Table


def measure_mixed(*, quick: bool) -> list[Table]:
    """Fly all missions; return a table for each contender.

    `quick` flies one mission of 2 s a point instead of ten of 100 s. Raises OracleUnavailable without SciPy.
    """
    seeds, seconds = (1, 2.0) if quick else (10, 100.0)
    flown = (best_mode(), best_mode_expecting(), best_mode_knowing(), paper_mode())
    measured = fly_all(points("mixed"), flown, seeds=seeds, seconds=seconds, alone=quick)
    note = (
        f"{seeds} missions of {seconds:g} s a point, latency 10 ms, horizon 60, one central decider."
        " No constraint was broken."
    )
    return [share_table(c.name, c.name, measured, note) for c in flown]
