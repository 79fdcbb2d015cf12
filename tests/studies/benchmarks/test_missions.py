"""Missions flown at points of a grid."""

from functools import partial

import pytest

from studies.benchmarks.missions import Point, best_mode, fly_all, points, share_table
from studies.benchmarks.quality import RuleBrokenError
from studies.policies import Contender, send_all


def sending_all(*, lawful):
    """A contender that claims to keep the constraints, or not."""
    return Contender("all", lambda _: send_all, lawful=lawful)


def test_a_flight_that_breaks_a_constraint_is_not_measured():
    """Its utility would mean nothing, unless it says so."""
    fly = partial(fly_all, [Point(0, 0)], seeds=1, seconds=3.0, alone=True)
    with pytest.raises(RuleBrokenError, match="few important"):
        fly([sending_all(lawful=True)])
    (measured,) = fly([sending_all(lawful=False)])
    assert measured.share > 1


def test_tables_show_the_mean_and_the_worst_mission_of_each_point():
    """Missions of one point and contender share a cell."""
    where = points("mixed")[:3]
    measured = fly_all(where, [best_mode(30)], seeds=2, seconds=3.0, alone=True)
    table = share_table("title", best_mode(30).name, measured, "note")
    (row,) = table.rows
    assert row[0] == "8 % of the bytes, per 2.5 s"
    for point, cell in zip(where, row[1:], strict=True):
        shares = [100 * one.share for one in measured if one.point == point]
        assert len(shares) == 2
        assert cell == f"{sum(shares) / 2:.2f} ({min(shares):.2f})"


@pytest.mark.full
def test_processes_measure_what_one_does():
    """How the work is shared changes no figure."""
    where = [Point(1, 1, latency=0.3)]
    alone, shared = (fly_all(where, [best_mode(30)], seeds=2, seconds=3.0, alone=alone) for alone in (True, False))
    assert [one.share for one in alone] == [one.share for one in shared]
