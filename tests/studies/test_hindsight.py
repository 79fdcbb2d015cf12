"""The yardsticks among forecasts."""

import pytest

from studies.hindsight import announced, foreknown
from studies.outlook import PRIOR
from studies.workload import MOST_IMPORTANT, mission


def test_hindsight_knows_the_period_of_the_whole_mission_and_the_phase_of_what_it_saw():
    """Before its first message a stream is expected in the middle of its first period."""
    flown = mission(MOST_IMPORTANT, seed=1, seconds=20.0)
    for stream, known in foreknown(flown):
        own = [m for m in flown.messages if m.stream == stream]
        period = own[1].t_gen - own[0].t_gen
        assert known.outlook().means(0.0, 1) == pytest.approx([period / 2])
        known.observe(own[0])
        assert known.outlook().means(own[0].t_gen, 2) == pytest.approx([own[1].t_gen, own[2].t_gen])
        assert known.uses().tolist() == [[1.0]] * len(own)


def test_specs_tell_what_a_stream_carries_but_not_when():
    """All streams that will be, each as its first message has it, of the core's guess of a period."""
    flown = mission(MOST_IMPORTANT, seed=1, seconds=20.0)
    told = announced(flown)
    assert set(told) == set(range(10))
    assert {outlook.period for outlook in told.values()} == {PRIOR}
    assert {outlook.typical.scale for outlook in told.values()} == {m.scale for m in flown.messages}
