"""Paper mode beside the paper: what its deviations from §3 are worth, and the reductions of §3.2, each alone."""

from studies.benchmarks.deviations import measure_deviations
from studies.benchmarks.reductions import measure_reductions
from studies.benchmarks.report import Figure, Table


def measure_paper_mode(*, quick: bool) -> list[Table | Figure]:
    """Measure both; `quick` takes seconds instead of a quarter of an hour. Raises OracleUnavailable without SciPy."""
    return [*measure_deviations(quick=quick), *measure_reductions(quick=quick)]
