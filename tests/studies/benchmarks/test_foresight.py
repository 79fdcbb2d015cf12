"""What forecasts that know the future are worth."""

import pytest

from studies.benchmarks.foresight import SEEN, fly, forecasts
from studies.benchmarks.missions import Point
from studies.workload import SCENARIOS


def test_every_forecast_flies_the_same_mission_and_stays_below_the_bound():
    """Counted from the start and after ten seconds; those that know who there is beforehand are ahead at first."""
    flown = fly((Point(limit=1, scenario=1), 0), seconds=12.0)
    assert [one.forecast for one in flown] == [each.name for each in forecasts()]
    for one in flown:
        assert 0.5 < one.share <= 1 + 1e-9
        assert 0.5 < one.settled <= 1 + 1e-9
    seen, *knowing = flown
    assert seen.forecast == SEEN
    assert all(one.share > seen.share for one in knowing)
    assert len({(one.share, one.settled) for one in flown}) > 1


@pytest.mark.full
def test_its_table_has_a_row_for_each_forecast(measured):
    """The first is what the others are compared with."""
    (table,) = measured("foresight")
    assert [row[0] for row in table.rows] == [each.name for each in forecasts()]
    assert table.columns[1 : 1 + len(SCENARIOS)] == tuple(scenario.name for scenario in SCENARIOS)
    assert [row[6] == "–" for row in table.rows] == [True, False, False, False]
