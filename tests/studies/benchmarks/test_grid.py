"""The grid benchmark: what its tables hold, and that long constraint windows cost best mode little."""

import pytest

from planner import Constraint, SearchSettings
from planner.definition import utility
from studies.benchmarks import grid
from studies.benchmarks.grid import FLIGHTS, LIMITS, Mission, fly, measure_grid
from studies.benchmarks.quality import RuleBrokenError
from studies.central import CentralDecider
from studies.oracle import upper_bound
from studies.policies import Planned
from studies.workload import MOST_IMPORTANT, SCENARIOS, mission


def test_a_table_for_each_way_to_fly_has_a_row_for_each_limit():
    """Every cell is a share of the bound between nothing and all, its worst mission beside it."""
    tables = measure_grid(quick=True)
    assert [table.title.split(": ")[1] for table in tables] == [flight.name for flight in FLIGHTS]
    for table in tables:
        assert table.columns[1:] == tuple(scenario.name for scenario in SCENARIOS)
        assert [row[0] for row in table.rows] == [f"{c.limit:g} per {c.window:g} s" for c in LIMITS]
        for cell in (cell for row in table.rows for cell in row[1:]):
            mean, worst = (float(part.strip("()")) for part in cell.split())
            assert 0 < worst <= mean <= 100.01


def test_long_windows_cost_best_mode_little():
    """With a limit per 2.5 s, best mode loses little of the bound, whatever it knows of the future."""
    flown = mission(MOST_IMPORTANT, seed=3, seconds=30.0, constraint=Constraint("messages", 2.5, 5.0))
    bound = upper_bound(flown).bound
    for forecast in (True, False):
        sends = CentralDecider(flown, 60, forecast=forecast).fly(Planned(SearchSettings(), 300))
        assert utility(flown, sends) >= 0.98 * bound


def test_a_flight_that_breaks_a_constraint_is_not_measured(monkeypatch):
    """Its utility would mean nothing."""
    monkeypatch.setattr(grid, "Planned", lambda *_: lambda _: True)
    with pytest.raises(RuleBrokenError, match="few important"):
        fly(Mission(limit=0, scenario=0, seed=0, seconds=3.0))
