"""What more iterations give best mode."""

from studies.benchmarks.missions import best_mode, fly_all, points, share_table
from studies.benchmarks.report import Table

BUDGETS = (300, 1_500, 10_000)
"""Iterations of a decision."""


def measure_iterations(*, quick: bool) -> list[Table]:
    """Fly the same missions with every budget; return a table for each.

    `quick` flies one mission of 2 s at the tightest limit instead of two of 100 s.
    Raises OracleUnavailable without SciPy.
    """
    seeds, seconds = (1, 2.0) if quick else (2, 100.0)
    flown = [best_mode(budget) for budget in BUDGETS]
    measured = fly_all(points()[: 3 if quick else None], flown, seeds=seeds, seconds=seconds, alone=quick)
    note = (
        f"{seeds} missions of {seconds:g} s a point, latency 10 ms, horizon 60, one central decider."
        " No constraint was broken."
    )
    return [share_table(c.name, c.name, measured, note) for c in flown]
