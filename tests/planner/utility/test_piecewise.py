"""Piecewise linear functions."""

import numpy as np

from planner.utility.piecewise import PiecewiseLinear


def test_the_first_point_is_at_age_zero():
    """A point is added where there is none."""
    assert PiecewiseLinear.through(np.array([2.0, 4.0]), np.array([3.0, 1.0])).points.tolist() == [
        [0.0, 2.0, 4.0],
        [3.0, 3.0, 1.0],
        [0.0, -1.0, 0.0],
        [0.0, 6.0, 10.0],
    ]


def test_the_area_of_a_row_is_that_of_the_function_whose_point_is_meant():
    """Points are counted through."""
    one = PiecewiseLinear.through(np.array([0.0]), np.array([2.0]))
    two = PiecewiseLinear.through(np.array([0.0, 1.0]), np.array([1.0, 0.0]))
    row = PiecewiseLinear.row([one, two])
    assert row.area(np.array([0, 1, 2]), np.array([3.0, 1.0, 5.0])).tolist() == [6.0, 0.5, 0.5]


def test_what_overflows_is_not_finite():
    """No warning, no error: whoever makes one asks."""
    assert PiecewiseLinear.through(np.array([0.0, 1.0]), np.array([1.0, 0.0])).finite
    assert not PiecewiseLinear.through(np.array([0.0, 1e-310]), np.array([1.0, 0.0])).finite
    assert not PiecewiseLinear.through(np.array([0.0, 1e300]), np.array([1e300, 1e300])).finite
