"""Best mode beside the exact receding-horizon optimiser: what the search itself loses."""

from statistics import fmean

from studies.benchmarks.missions import Measured, best_mode, fly_all, points, receding, share_table
from studies.benchmarks.report import Table


def measure_receding(*, quick: bool) -> list[Table]:
    """Compare best mode with the exact receding-horizon optimiser on the paper's workload, with fewer missions.

    `quick` flies one mission of 2 s at the tightest limit instead of one of 30 s.
    Raises OracleUnavailable without SciPy.
    """
    seeds, seconds = (1, 2.0) if quick else (1, 30.0)
    flown = (best_mode(), receding(beyond=True), receding(beyond=False))
    measured = fly_all(points()[: 3 if quick else None], flown, seeds=seeds, seconds=seconds, alone=quick)
    missions = f"Only {seeds} mission of {seconds:g} s a point, latency 10 ms, horizon 60, one central decider."
    return [share_table(c.name, c.name, measured, f"{missions} {_effort(c.name, measured)}") for c in flown]


def _effort(contender: str, measured: list[Measured]) -> str:
    """Say how long its decisions took, windows and forecasts included, and what was not proven."""
    own = [one for one in measured if one.contender == contender]
    times = [1e3 * one.decision for one in own]
    unproven = sum(one.unproven for one in own)
    proof = f" Windows without proof: {unproven}." if "exact" in contender else ""
    return f"A decision took {fmean(times):.1f} ms, at most {max(times):.1f} ms in the mean of a mission.{proof}"
