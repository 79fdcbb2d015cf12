"""The designs benchmark: what its tables hold."""

import pytest

from planner import Problem
from studies.benchmarks.designs import FLOWN_LONG, Mission, fly, search
from studies.benchmarks.quality import RuleBrokenError
from studies.designs.catalogue import AS_IT_IS, catalogue
from studies.designs.design import Decider, Design

NAMES = [design.name for design in catalogue()]


def test_tables_have_a_row_for_each_design(measured):
    """Losses by point and their mean, then the work; windows for those that maximise the objective."""
    short, long, windows = measured("designs")
    assert [row[0] for row in short.rows] == NAMES
    assert sorted(row[0] for row in long.rows) == sorted(FLOWN_LONG)
    assert set(NAMES) - {row[0] for row in windows.rows} == {
        *(name for name in NAMES if name.startswith("paper")),
        "best mode without what lies beyond",
    }
    for table in (short, long, windows):
        for row in table.rows:
            *each, mean = map(float, row[1:5])
            assert -0.01 <= min(each) <= mean <= max(each) <= 100
    assert "proven for 3 of 3" in short.note
    assert "proven for 6 of 6" in windows.note


@pytest.mark.full
def test_best_mode_finds_the_best_plans_of_easy_windows():
    """With a short horizon nothing is lost, and it shows."""
    measured = {one.design: one for one in search(Mission(0, 1, 5, 8.0), horizon=12, begin=20, count=3)}
    assert measured[AS_IT_IS].lost == pytest.approx(0.0, abs=1e-9)
    assert measured[AS_IT_IS].right == 1.0
    assert measured["paper, mean"].lost is None


class Careless(Decider):
    """Sends everything."""

    def decide(self, window: Problem) -> bool:
        del window
        return True


def test_a_design_that_breaks_a_constraint_is_not_measured(monkeypatch):
    """Its utility would mean nothing."""
    monkeypatch.setattr(Design, "decider", lambda design: Careless(design.begin(), 1))
    with pytest.raises(RuleBrokenError, match=AS_IT_IS):
        fly(Mission(0, 0, 0, 3.0), names=[AS_IT_IS], horizon=10)
