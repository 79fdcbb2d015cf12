"""The page of the shared view."""

from itertools import islice

import pytest

from studies.benchmarks.view import adaptive
from studies.benchmarks.view.crowd import KINDS
from studies.benchmarks.view.programme import ARRANGEMENTS, QUICK, programme, wrong_clocks


@pytest.fixture
def tables(measured):
    """A quick page."""
    return measured("view")


def test_every_target_has_a_row(tables):
    """With what is asked, and whether it is met."""
    rows = {row[0]: row for row in tables[0].rows}
    assert all(row[-1] in ("yes", "no", "not measured") for row in rows.values())
    for words in ("generation times", "right clocks", "central decider", "exceeds", "Latency 1 s", "tells the others"):
        assert any(words in name for name in rows)


def test_where_each_robot_has_a_part_none_of_the_windows_is_over(tables):
    """By construction."""
    rows = [row for row in tables[0].rows if row[0].startswith("Windows") and "split" in row[0]]
    assert [row[-1] for row in rows] == ["yes"]


def test_what_bad_networks_cost_is_told_for_each_arrangement(tables):
    """A row for each condition."""
    costs = tables[1]
    assert len(costs.columns) == 1 + len(ARRANGEMENTS)
    assert len(costs.rows) == 2 + len(QUICK.latencies) + len(QUICK.losses) + len(wrong_clocks(QUICK)) + 1
    assert len(tables[2].rows) == len(ARRANGEMENTS)


@pytest.mark.full
def test_limits_that_follow_the_medium_are_measured_beside_right_ones(monkeypatch):
    """A limit that never exceeds the least rate keeps delays short; one far below it reaches less."""
    course = adaptive.Course(teams=(2,), seeds=(1,), halved=6.0, doubled=13.0, end=16.0)
    right = f'limit = "{adaptive.PART * adaptive.RATE / 2.0} B/s"'
    monkeypatch.setattr(adaptive, "ADAPTIVE", right)
    constant, halved = islice(adaptive.adaptive_rows(course), 2)
    assert (constant[-1], halved[-1]) == ("no", "yes")
    monkeypatch.setattr(adaptive, "ADAPTIVE", 'limit = "10 kB/s"')
    assert all(row[-1] == "no" for row in islice(adaptive.adaptive_rows(course), 3))


def test_a_crowd_is_measured_beside_a_team(tables):
    """The same figures of both, in either coordination."""
    assert tables[3].columns[1:] == KINDS
    assert len(tables[3].rows) == 4


def test_all_arrangements_fly_the_same_missions():
    """So that they can be compared."""
    for flights in programme(QUICK).values():
        courses = [
            [f.course for f in flights if (f.how.coordination, f.how.transport) == each] for each in ARRANGEMENTS
        ]
        assert courses[0] == courses[1] == courses[2]
