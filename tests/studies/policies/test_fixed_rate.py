"""Fixed rates per stream."""

from itertools import pairwise

import pytest

from planner import Constraint
from planner.constraints import violations
from studies.central import CentralDecider
from studies.policies import FixedRate, filling_interval
from studies.workload import FEW_IMPORTANT, mission


def test_messages_of_a_stream_lie_the_interval_apart():
    """The flight keeps the interval of every stream and breaks no constraint."""
    flown = mission(FEW_IMPORTANT, seed=0, seconds=20.0, constraint=Constraint("messages", 2.5, 5.0))
    sends = CentralDecider(flown, 10).fly(FixedRate(3.0))
    assert violations(flown, sends) == []
    for stream in range(10):
        times = [flown.messages[i].t_sent for i in sends if flown.messages[i].stream == stream]
        assert all(after - before >= 3.0 for before, after in pairwise(times))


def test_the_filling_interval_uses_what_the_limits_carry():
    """Ten streams that share two messages a second may each send every five seconds; where all fits, all is sent."""
    tight = mission(FEW_IMPORTANT, seed=0, constraint=Constraint("messages", 2.5, 5.0))
    assert filling_interval(tight) == pytest.approx(5.0)
    loose = mission(FEW_IMPORTANT, seed=0, constraint=Constraint("messages", 2.5, 100.0))
    assert filling_interval(loose) == 0.0
