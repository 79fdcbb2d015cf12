"""The constraint windows as rows."""

from dataclasses import replace

import numpy as np
import pytest

from planner import Traffic
from studies.oracle.windows import build_rows
from tests.studies.oracle.problems import one_stream


def as_lists(rows):
    return [sorted(rows.message[rows.row == r].tolist()) for r in range(len(rows.room))]


def test_windows_within_others_have_no_row():
    """Of the windows that end with each message only those that no later one contains are left."""
    rows = build_rows(one_stream([0.0, 0.25, 0.5, 2.0, 2.25], window=0.5, limit=1.0))
    assert as_lists(rows) == [[0, 1, 2], [3, 4]]


def test_windows_with_room_for_all_have_no_row():
    """A window that cannot be overfilled says nothing."""
    assert as_lists(build_rows(one_stream([0.0, 0.25, 0.5], window=0.5, limit=3.0))) == []


def test_fixed_traffic_leaves_less_room():
    """Room is counted in limits, less what is sent anyway."""
    problem = one_stream([0.0, 0.25], window=0.5, limit=4.0, sizes=[2.0, 2.0])
    rows = build_rows(replace(problem, traffic=(Traffic(0.1, (1.0,)),)))
    assert rows.room == pytest.approx([0.75])
    assert rows.share == pytest.approx([0.5, 0.5])


def test_stretched_windows_have_rows_of_their_own():
    """An oversized message shuts out each window's worth of messages before it."""
    rows = build_rows(one_stream([0.0, 1.0, 2.0, 3.0], window=1.0, limit=1.0, sizes=[1.0, 1.0, 1.0, 3.5]))
    assert [0, 1, 3] in as_lists(rows)
    assert [2, 3] in as_lists(rows)
    assert np.all(rows.share <= 1.0)


def test_an_oversized_message_near_anything_fixed_is_banned():
    """An oversized message has its window for itself; so has oversized traffic."""
    problem = one_stream([0.0, 1.0, 2.0], window=0.5, limit=1.0, sizes=[1.0, 1.0, 3.0])
    before = build_rows(replace(problem, traffic=(Traffic(0.75, (0.5,)),)))
    assert before.banned.tolist() == [False, False, True]
    after = build_rows(replace(problem, traffic=(Traffic(2.0, (3.0,)),)))
    assert after.banned.tolist() == [False, True, True]


def test_windows_that_end_soon_after_another_may_be_left_out():
    """What is left are rows of the whole, so nothing is forbidden that was allowed."""
    problem = one_stream([0.0, 0.1, 0.2, 0.3, 0.4, 0.5], window=0.15, limit=1.0)
    assert as_lists(build_rows(problem)) == [[0, 1], [1, 2], [2, 3], [3, 4], [4, 5]]
    assert as_lists(build_rows(problem, every=0.19)) == [[1, 2], [3, 4]]
