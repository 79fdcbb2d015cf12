"""Video message utility."""

import math

import numpy as np
import pytest

from planner import ProblemError, Video


def test_doubling_the_frame_rate_adds_a_constant():
    """Between a0 and a1 twice the age costs a fixed part of the video utility."""
    utility = Video(a0=1 / 30, a1=10.0)
    values = utility.value(np.array([0.1, 0.2, 0.4, 0.8]))
    assert np.diff(values) == pytest.approx([-math.log(2) / math.log(300)] * 3)
    assert utility.value(np.array([0.0, 1 / 30, 10.0, 20.0])) == pytest.approx([1.0, 1.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("build", "says"),
    [
        (lambda: Video(0.0, 1.0), "0 < a0 < a1"),
        (lambda: Video(2.0, 1.0), "0 < a0 < a1"),
        (lambda: Video(1.0, math.nan), "0 < a0 < a1"),
    ],
)
def test_parameters_without_meaning_are_refused(build, says):
    """The error names kind, parameter and value."""
    with pytest.raises(ProblemError, match=says):
        build()
