"""The grid: what share of the offline bound missions reach, from tight limits to loose, on the paper's workload."""

from functools import partial

from planner import Problem
from studies.benchmarks.charts import Chart
from studies.benchmarks.missions import (
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
from studies.central import Policy
from studies.policies import (
    Contender,
    FixedRate,
    RandomSends,
    by_age,
    by_rank,
    filling_interval,
    send_all,
    whenever_it_fits,
)

RANDOM_SEED = 1

TARGET = 97.0
"""What best mode is to reach at every point [%]."""


def contenders() -> tuple[Contender, ...]:
    """Return what flies the grid: the planner, then the simple policies."""
    return (
        best_mode(),
        best_mode_sampling(),
        best_mode_knowing(),
        paper_mode(),
        Contender("by rank of marginal utility", partial(_stateless, by_rank)),
        Contender("by index of the age of information", partial(_stateless, by_age)),
        Contender("fixed rate per stream that fills the limit, when it fits", _fixed_rate),
        Contender("whenever it fits", partial(_stateless, whenever_it_fits)),
        Contender("at random, every second message, when it fits", _random),
        Contender("send all (ignores the limits)", partial(_stateless, send_all), lawful=False),
    )


def measure_grid(*, quick: bool) -> list[Table | Chart]:
    """Fly all missions of the grid; return a table for each contender, and charts of all that keep the limits.

    `quick` flies one mission of 2 s a point instead of ten of 100 s. Raises OracleUnavailable without SciPy.
    """
    seeds, seconds = (1, 2.0) if quick else (10, 100.0)
    flown = contenders()
    measured = fly_all(points(), flown, seeds=seeds, seconds=seconds, alone=quick)
    note = f"{seeds} missions of {seconds:g} s a point, latency 10 ms, horizon 60, one central decider. "
    lawful = note + "No constraint was broken."
    return [
        *share_charts("Share of the offline bound", [c for c in flown if c.lawful], measured, TARGET),
        *(share_table(c.name, c.name, measured, lawful if c.lawful else note + "Not allowed.") for c in flown),
    ]


def _stateless(policy: Policy, _mission: Problem) -> Policy:
    return policy


def _fixed_rate(mission: Problem) -> Policy:
    return FixedRate(filling_interval(mission))


def _random(_mission: Problem) -> Policy:
    return RandomSends(0.5, RANDOM_SEED)
