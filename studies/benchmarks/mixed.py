"""The grid on the mixed workload: several kinds of streams per robot, 0.2 to 50 kB, limits in bytes."""

from functools import partial
from statistics import fmean

from studies.benchmarks.charts import Chart
from studies.benchmarks.missions import (
    Point,
    best_mode,
    best_mode_knowing,
    best_mode_sampling,
    fly_all,
    paper_mode,
    points,
    share_charts,
    share_table,
)
from studies.benchmarks.report import Table
from studies.mixed_workload import BYTE_LIMITS
from studies.oracle import optimum, upper_bound
from studies.processes import processes
from studies.workload import SCENARIOS

TARGET = 96.0
"""What best mode is to reach at every point [%]."""

SHORT = 30.0
"""Length of the missions whose integer optimum is sought [s]."""

PATIENCE = 8.0
"""What it may take [s]; where the time is up, the best plan found so far stands in."""


def measure_mixed(*, quick: bool) -> list[Table | Chart]:
    """Fly all missions; return charts, a table for each contender, and what whole messages can reach at all.

    `quick` flies one mission of 2 s a point instead of three of 100 s. Raises OracleUnavailable without SciPy.
    """
    seeds, seconds = (1, 2.0) if quick else (3, 100.0)
    flown = (best_mode(), best_mode_sampling(), best_mode_knowing(), paper_mode())
    measured = fly_all(points("mixed"), flown, seeds=seeds, seconds=seconds, alone=quick)
    note = (
        f"{seeds} missions of {seconds:g} s a point, latency 10 ms, horizon 60, one central decider."
        " No constraint was broken."
    )
    return [
        *share_charts("Share of the offline bound, mixed sizes", flown, measured, TARGET),
        *(share_table(c.name, c.name, measured, note) for c in flown),
        _attainable(quick=quick),
    ]


def _attainable(*, quick: bool) -> Table:
    """Return what the integer optimum of short missions reaches of the bound."""
    seeds, seconds = (1, 2.0) if quick else (2, SHORT)
    work = partial(_optimum, seeds=seeds, seconds=seconds)
    if quick:
        cells = [work(point) for point in points("mixed")]
    else:
        with processes() as pool:
            cells = list(pool.map(work, points("mixed")))
    columns = len(SCENARIOS)
    rows = (cells[at : at + columns] for at in range(0, len(cells), columns))
    names = (Point(limit, 0, "mixed").limit_name() for limit in range(len(BYTE_LIMITS)))
    return Table(
        "What whole messages can reach",
        ("limit", *(scenario.name for scenario in SCENARIOS)),
        tuple((name, *row) for name, row in zip(names, rows, strict=True)),
        f"The integer optimum, with everything known beforehand, as a share of the same bound [%], which sends"
        f" fractions of messages; in brackets the largest message in limits of a window. {seeds} missions of"
        f" {seconds:g} s a point, at most {PATIENCE:g} s each; ~: the best plan found until then, for one at least.",
    )


def _optimum(point: Point, *, seeds: int, seconds: float) -> str:
    shares, largest, exact = [], 0.0, True
    for seed in range(seeds):
        flown = point.mission(seed, seconds)
        best = optimum(flown, PATIENCE)
        shares.append(best.utility / upper_bound(flown).bound)
        largest = max(largest, max(m.use[0] for m in flown.messages) / flown.constraints[0].limit)
        exact = exact and best.exact
    return f"{'' if exact else '~'}{100 * fmean(shares):.1f} ({largest:.1f})"
