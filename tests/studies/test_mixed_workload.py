"""The mixed workload has the kinds, sizes and limits that it promises."""

import numpy as np
import pytest

from planner import Linear, Video
from planner.validation import check_problem
from studies.mixed_workload import BYTE_LIMITS, GREATEST_SIZE, LEAST_SIZE, ROBOTS, mixed_mission
from studies.workload import SCENARIOS


@pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda scenario: scenario.name)
def test_missions_are_valid_and_repeatable(scenario):
    """A mission has a meaning for the planner; its seed gives it again and another seed another one."""
    drawn = mixed_mission(scenario, seed=3)
    check_problem(drawn)
    assert drawn == mixed_mission(scenario, seed=3)
    assert drawn.messages != mixed_mission(scenario, seed=4).messages
    assert tuple(stream.robot for stream in drawn.streams) == ROBOTS
    assert {type(m.utility) for m in drawn.messages} == {Linear, Video}


def test_sizes_span_decades_and_spread_little_within_a_stream():
    """Streams lie log-uniformly between the least and the greatest size."""
    missions = [mixed_mission(SCENARIOS[1], seed, seconds=20.0) for seed in range(30)]
    sizes = [[m.use[0] for m in drawn.messages if m.stream == stream] for drawn in missions for stream in range(10)]
    middles = np.log([np.median(own) for own in sizes])
    assert middles.mean() == pytest.approx(np.log(LEAST_SIZE * GREATEST_SIZE) / 2, abs=0.2)
    assert middles.std() == pytest.approx(np.log(GREATEST_SIZE / LEAST_SIZE) / 12**0.5, abs=0.15)
    assert np.mean([np.std(np.log(own)) for own in sizes]) == pytest.approx(0.2, abs=0.03)
    assert all(LEAST_SIZE <= size <= GREATEST_SIZE for own in sizes for size in own)


@pytest.mark.parametrize("limit", BYTE_LIMITS)
def test_limits_carry_their_share_of_the_bytes(limit):
    """What the constraint lets through a second is the share of what is generated."""
    drawn = mixed_mission(SCENARIOS[0], seed=1, seconds=50.0, limit=limit)
    constraint = drawn.constraints[0]
    generated = sum(m.use[0] for m in drawn.messages) / 50.0
    assert constraint.limit / constraint.window == pytest.approx(limit.share * generated)
