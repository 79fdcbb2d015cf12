"""Message utility functions and their integrals."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from planner import Linear, MessageUtility, ProblemError, Video
from planner.utility import Batched

linear = st.builds(Linear, st.floats(0, 100), st.floats(1e-3, 100))
video = st.builds(Video, st.floats(1e-3, 1), st.floats(1.1, 100))
ages = st.tuples(st.floats(0, 50), st.floats(0, 50)).map(sorted)


def by_quadrature(utility: MessageUtility, start: float, end: float) -> float:
    corners = [a for a in (utility.u0 / utility.slope,) if start < a < end] if isinstance(utility, Linear) else []
    corners += [a for a in (utility.a0, utility.a1) if start < a < end] if isinstance(utility, Video) else []
    edges = [start, *sorted(corners), end]
    pieces = itertools.pairwise(edges)
    return sum(quad(lambda age: float(utility.value(np.array([age]))[0]), a, b)[0] for a, b in pieces)


@given(st.one_of(linear, video), ages)
def test_integral_equals_quadrature(utility, span):
    """The closed form of the integral agrees with numerical quadrature between any two ages."""
    start, end = span
    closed = float(utility.integral(np.array([start]), np.array([end]))[0])
    assert closed == pytest.approx(by_quadrature(utility, start, end), rel=1e-6, abs=1e-9)


@given(st.one_of(st.lists(linear, min_size=1, max_size=5), st.lists(video, min_size=1, max_size=5)), ages)
def test_many_messages_integrate_as_each_alone(utilities, span):
    """The batched integral of a kind gives what each of its messages gives alone."""
    kind = type(utilities[0])
    assert issubclass(kind, Batched)
    which = np.arange(len(utilities))[::-1].copy()
    start, end = (np.full(len(utilities), age) for age in span)
    batch = kind.integrals(utilities, which, start, end)
    alone = [float(utilities[at].integral(start[:1], end[:1])[0]) for at in which]
    assert batch.tolist() == pytest.approx(alone, rel=1e-12, abs=1e-12)


@given(st.one_of(linear, video))
def test_value_never_rises_with_age(utility):
    """A message is worth most when fresh, and nothing before it exists."""
    values = utility.value(np.linspace(-1, 60, 500))
    assert (values[:8] == 0).all()
    assert (np.diff(values[9:]) <= 1e-12).all()
    assert (values >= -1e-12).all()


def test_linear_values():
    """A linear utility falls from u0 by its slope and stops at zero."""
    assert Linear(2.0, 0.5).value(np.array([0.0, 1.0, 4.0, 9.0])).tolist() == [2.0, 1.5, 0.0, 0.0]
    assert Linear(2.0, 0.5).integral(np.array([0.0]), np.array([100.0])).tolist() == [4.0]


def test_doubling_the_frame_rate_adds_a_constant():
    """Between a0 and a1 twice the age costs a fixed part of the video utility."""
    utility = Video(a0=1 / 30, a1=10.0)
    values = utility.value(np.array([0.1, 0.2, 0.4, 0.8]))
    assert np.diff(values) == pytest.approx([-math.log(2) / math.log(300)] * 3)
    assert utility.value(np.array([0.0, 1 / 30, 10.0, 20.0])) == pytest.approx([1.0, 1.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("build", "says"),
    [
        (lambda: Linear(-1.0, 1.0), "u0 must be"),
        (lambda: Linear(math.nan, 1.0), "u0 must be"),
        (lambda: Linear(1.0, 0.0), "slope must be"),
        (lambda: Linear(1.0, math.inf), "slope must be"),
        (lambda: Video(0.0, 1.0), "0 < a0 < a1"),
        (lambda: Video(2.0, 1.0), "0 < a0 < a1"),
        (lambda: Video(1.0, math.nan), "0 < a0 < a1"),
    ],
)
def test_parameters_without_meaning_are_refused(build, says):
    """Parameters outside their range raise an error that names them."""
    with pytest.raises(ProblemError, match=says):
        build()
