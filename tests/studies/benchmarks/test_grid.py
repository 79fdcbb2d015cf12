"""The grid benchmark: what its tables hold, and that long constraint windows cost best mode little."""

import pytest

from planner import Constraint, SearchSettings
from planner.definition import utility
from studies.benchmarks.grid import contenders
from studies.benchmarks.missions import LIMITS
from studies.central import CentralDecider
from studies.oracle import upper_bound
from studies.policies import Planned
from studies.workload import MOST_IMPORTANT, SCENARIOS, mission


def test_a_table_for_each_contender_has_a_row_for_each_limit(measured):
    """Every cell is a share of the bound, its worst mission beside it; who keeps the limits stays below the bound."""
    results = measured("grid")
    charts, tables = results[:3], results[3:]
    assert [len(chart.series) for chart in charts] == [len(contenders()) - 1] * 3
    assert [table.title for table in tables] == [contender.name for contender in contenders()]
    for table, contender in zip(tables, contenders(), strict=True):
        assert table.columns[1:] == tuple(scenario.name for scenario in SCENARIOS)
        assert [row[0] for row in table.rows] == [f"{c.limit:g} per {c.window:g} s" for c in LIMITS]
        for cell in (cell for row in table.rows for cell in row[1:]):
            mean, worst = (float(part.strip("()")) for part in cell.split())
            assert 0 < worst <= mean
            assert mean <= 100.01 or not contender.lawful


@pytest.mark.full
def test_long_windows_cost_best_mode_little():
    """With a limit per 2.5 s, best mode loses little of the bound, whatever it knows of the future."""
    flown = mission(MOST_IMPORTANT, seed=3, seconds=30.0, constraint=Constraint("messages", 2.5, 5.0))
    bound = upper_bound(flown).bound
    for forecast, futures in ((True, 0), (True, 3), (False, 0)):
        decider = CentralDecider(flown, 60, forecast=forecast, futures=futures)
        assert utility(flown, decider.fly(Planned(SearchSettings(), 300))) >= 0.98 * bound
