"""Message utility through given points."""

import math

import numpy as np
import pytest

from planner import ProblemError, Table


def test_values_lie_on_straight_lines_and_hold_at_both_ends():
    """Before the first point its value holds, after the last one for ever."""
    utility = Table(((1.0, 4.0), (3.0, 2.0)))
    assert utility.value(np.array([0.0, 1.0, 2.0, 3.0, 99.0])).tolist() == [4.0, 4.0, 3.0, 2.0, 2.0]
    assert utility.integral(np.array([0.0, 0.0, 2.0, 3.0]), np.array([1.0, 3.0, 3.0, 13.0])).tolist() == [
        4,
        10,
        2.5,
        20,
    ]


def test_one_point_is_a_constant():
    """A value that age does not change."""
    assert Table(((5.0, 2.0),)).integral(np.array([0.0, 4.0]), np.array([3.0, 9.0])).tolist() == [6.0, 10.0]


def test_tables_of_different_length_share_a_window():
    """Each message finds its own points."""
    tables = [Table(((0.0, 1.0),)), Table(((0.0, 4.0), (2.0, 0.0))), Table(((1.0, 3.0), (2.0, 1.0), (4.0, 0.0)))]
    which, start = np.array([2, 0, 1, 2, 1]), np.array([0.0, 7.0, 0.0, 2.0, 5.0])
    assert Table.integrals(tables, which, start, start + 2.0).tolist() == [5.0, 2.0, 4.0, 1.0, 0.0]


@pytest.mark.parametrize(
    ("build", "says"),
    [
        (lambda: Table(()), "table utility: points must hold at least one"),
        (lambda: Table(((-1.0, 1.0),)), "table utility: points must have finite ages >= 0, not -1.0"),
        (lambda: Table(((math.inf, 1.0),)), "finite ages >= 0, not inf"),
        (lambda: Table(((0.0, -1.0),)), "table utility: points must have finite values >= 0, not -1.0"),
        (lambda: Table(((0.0, math.nan),)), "finite values >= 0, not nan"),
        (lambda: Table(((1.0, 1.0), (1.0, 0.0))), "table utility: points must have rising ages, not 1.0 after 1.0"),
        (lambda: Table(((0.0, 1e308), (1e-300, 0.0))), "too close to each other or too large"),
        (lambda: Table(((0.0, 1e308), (1e300, 1e308))), "too close to each other or too large"),
    ],
)
def test_parameters_without_meaning_are_refused(build, says):
    """The error names kind, parameter and value."""
    with pytest.raises(ProblemError, match=says):
        build()
