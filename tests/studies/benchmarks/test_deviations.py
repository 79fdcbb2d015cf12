"""What deviations of paper mode are worth: every form flies, and is compared mission by mission."""

from functools import partial

import pytest

from studies.benchmarks import deviations
from studies.benchmarks.deviations import BUDGETS, Form, fly, forms, sizes
from studies.benchmarks.missions import Point
from studies.benchmarks.quality import RuleBrokenError

POINT = Point(limit=3, scenario=1)


@pytest.mark.full
def test_every_form_flies_the_same_mission_within_its_bound():
    """Paper mode as it is comes first; slow ones fly the first mission with the least budget."""
    job = partial(fly, catalogue=forms, iterations=BUDGETS[0], seconds=1.5)
    first, second = job((POINT, 0)), job((POINT, 1))
    assert [one.form for one in first] == [form.name for form in forms()]
    assert [one.form for one in second] == [form.name for form in forms() if not form.slow]
    assert all(0 < one.share <= 1 + 1e-9 for one in first + second)


@pytest.mark.full
def test_what_a_deviation_is_worth_is_told_mission_by_mission():
    """By how far paper mode as it is is ahead, of the missions that the other form flew."""
    first = [deviations.Flight(POINT, seed, "a", share) for seed, share in ((0, 0.9), (1, 0.7))]
    other = [deviations.Flight(POINT, 1, "b", 0.6)]
    assert deviations._more(first, other).mean == pytest.approx(0.1)
    assert deviations._more(first, first).mean == 0.0


def test_a_form_that_breaks_a_constraint_is_not_measured():
    """Its utility would mean nothing."""
    careless = Form("careless", lambda _flown, _iterations: lambda _window: True)
    with pytest.raises(RuleBrokenError, match="careless"):
        fly((Point(limit=0, scenario=0), 0), catalogue=lambda: (careless,), iterations=1, seconds=3.0)


def test_messages_larger_than_a_limit_are_there_to_be_compared():
    """The two forms differ where they are worth something."""
    shares = [
        one.share
        for one in fly((Point(limit=0, scenario=1, workload="mixed"), 0), catalogue=sizes, iterations=100, seconds=8.0)
    ]
    assert len(set(shares)) == 2


@pytest.mark.full
def test_tables_have_a_row_for_each_form(measured):
    """One for each budget, then the arena and the sizes."""
    few, many, arena, large, *_ = measured("paper_mode")
    assert [row[0] for row in few.rows] == [form.name for form in forms()]
    assert [row[0] for row in many.rows] == [form.name for form in forms() if not form.slow]
    assert all("±" in row[2] for row in few.rows[1:])
    assert len(arena.rows) == 2
    assert "24,576 iterations" in arena.note
    assert [row[0] for row in large.rows] == ["8 % of the bytes, per 2.5 s"]
