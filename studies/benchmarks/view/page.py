"""The page `view`: targets, costs, details, and a crowd of robots."""

from studies.benchmarks.report import Table
from studies.benchmarks.view.adaptive import QUICK as QUICK_COURSE
from studies.benchmarks.view.adaptive import Course, adaptive_rows
from studies.benchmarks.view.costs import cost_table, detail_table
from studies.benchmarks.view.crowd import measure_crowd
from studies.benchmarks.view.flown import fly_all
from studies.benchmarks.view.programme import QUICK, Extent, programme
from studies.benchmarks.view.targets import target_table


def measure_view(*, quick: bool) -> list[Table]:
    """Fly the programme and return its tables; `quick` flies three robots for seconds.

    Raises OracleUnavailable without SciPy.
    """
    extent = QUICK if quick else Extent()
    flights = programme(extent)
    flown = iter(fly_all((flight for each in flights.values() for flight in each), alone=quick))
    results = {name: [next(flown) for _ in each] for name, each in flights.items()}
    adaptive = list(adaptive_rows(QUICK_COURSE if quick else Course()))
    crowd = measure_crowd(quick=quick)
    return [target_table(results, extent, adaptive), cost_table(results, extent), detail_table(results), crowd]
