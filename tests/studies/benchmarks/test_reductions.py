"""The reductions of §3.2, each alone: trees with and without them, and what is counted of them."""

import pytest

from planner import SearchSettings
from planner.native_engine import NativeSearch
from planner.tables import tabulate
from studies.benchmarks.missions import Point
from studies.benchmarks.reductions import HORIZONS, TEAMS, WAYS, Watched, Way, draw_counts, fly, unconstrained
from studies.central import CentralDecider
from studies.workload import MIXED, TWO_PER_HALF_SECOND, mission

FLOWN = mission(MIXED, seed=1, seconds=20.0, constraint=TWO_PER_HALF_SECOND)


def trees(constrained, reduction):
    """Fly some of a mission by sending nothing; return what was counted."""
    watched = Watched(Way(constrained, reduction, 30))
    decider = CentralDecider(FLOWN, 30)
    for index in range(0, 101, 10):
        watched(decider.window(index))
    return watched


def test_each_reduction_lets_fewer_nodes_look_farther_ahead():
    """Constraints cut what may not be sent, Eq. 7 what is no better than another node."""
    free, allowed = trees(constrained=False, reduction="off"), trees(constrained=True, reduction="off")
    both = trees(constrained=True, reduction="exact")
    assert len(free.nodes) == 2  # every tenth
    assert sum(both.nodes) < sum(allowed.nodes) < sum(free.nodes)
    assert sum(both.levels) >= sum(allowed.levels) >= sum(free.levels)


def test_without_constraints_in_the_tree_only_the_current_message_is_checked():
    """So that what is sent keeps them."""
    decider = CentralDecider(FLOWN, 20)
    index = 0
    while len(decider.sends) < 2 or not tabulate(decider.window(index)).checks.never[0]:
        decider.send(index)
        index += 1
    window = unconstrained(decider.window(index))
    assert [m.use for m in window.messages if not m.sent][1:] == [(0.0,)] * 19
    search = NativeSearch(tabulate(window), SearchSettings(search="paper"))
    search.run(200)
    assert not search.plan().send
    assert len(search.plan().sends) > 2


def test_every_way_flies_the_same_mission_within_its_bound():
    """With each horizon."""
    flown = fly((Point(limit=4, scenario=1), 0), seconds=1.5)
    assert [one.way for one in flown] == list(WAYS)
    assert all(0 < one.share <= 1 + 1e-9 for one in flown)
    assert all(1 <= one.levels <= one.nodes for one in flown)


@pytest.mark.full
def test_tables_have_rows_for_every_limit_and_horizon(measured, tmp_path):
    """The figure comes first, then whole trees, utility with and without constraints, and trees that decided."""
    picture, whole, within, without, trees_ = measured("paper_mode")[4:]
    assert picture.draw(tmp_path) == draw_counts(tmp_path)
    assert {path.suffix for path in tmp_path.iterdir()} == {".svg", ".png"}
    assert {row[0].split(",")[0] for row in whole.rows} == {f"{team.most} of {team.held}" for team in TEAMS}
    assert [row[0] for row in within.rows] == [*(f"2 per 2.5 s, horizon {h}" for h in HORIZONS), "all"]
    assert [len(row) for row in (within.rows[0], without.rows[0], trees_.rows[0])] == [4, 5, 7]
