"""The workload has the statistics that the model gives it."""

import numpy as np
import pytest

from planner.validation import check_problem
from studies.workload import FEW_IMPORTANT, LEAST_SLOPE, MIXED, MOST_IMPORTANT, SCENARIOS, mission


def slopes(scenario, seeds=range(30)):
    """Mean slope of each stream of many missions [1/s]."""
    missions = [mission(scenario, seed, seconds=20.0).messages for seed in seeds]
    streams = [[m.utility.slope for m in drawn if m.stream == robot] for drawn in missions for robot in range(10)]
    return np.array([np.mean(stream) for stream in streams])


@pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda scenario: scenario.name)
def test_missions_are_valid_and_repeatable(scenario):
    """A mission has a meaning for the planner; its seed gives it again and another seed another one."""
    drawn = mission(scenario, seed=3)
    check_problem(drawn)
    assert drawn == mission(scenario, seed=3)
    assert drawn.messages != mission(scenario, seed=4).messages
    assert all(m.t_rcv == m.t_gen + 0.01 and m.utility.u0 == 1.0 for m in drawn.messages)


@pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda scenario: scenario.name)
def test_robots_publish_at_one_hertz(scenario):
    """The rates of the robots spread by a tenth around 1 Hz."""
    counts = [
        np.bincount([m.stream for m in mission(scenario, seed).messages], minlength=10) / 100 for seed in range(20)
    ]
    assert np.mean(counts) == pytest.approx(1.0, abs=0.03)
    assert np.std(counts) == pytest.approx(0.1, abs=0.03)


def test_slopes_follow_the_scenario():
    """Slopes spread over robots as given, but never below the least."""
    assert slopes(MIXED).mean() == pytest.approx(0.3, abs=0.003)
    assert slopes(MIXED).std() == pytest.approx(0.01, abs=0.002)
    assert slopes(MOST_IMPORTANT) == pytest.approx(0.7)
    few = slopes(FEW_IMPORTANT)
    assert few.min() >= LEAST_SLOPE
    assert np.median(few) == pytest.approx(0.2, abs=0.04)
    assert np.mean(few < 2 * LEAST_SLOPE) == pytest.approx(0.16, abs=0.06)


def test_weights_follow_the_scenario():
    """The weights of a few, of all evenly, or of most robots are great."""
    weights = {
        scenario.name: [next(m.scale for m in mission(scenario, 0).messages if m.stream == i) for i in (0, 1, 9)]
        for scenario in SCENARIOS
    }
    assert weights["few important"] == [3.0, 9.0, 3.0**10]
    assert weights["mixed"] == [1.0, 1001.0, 9001.0]
    assert weights["most important"] == pytest.approx([1.0, 2.0, 2.2457], abs=1e-4)


def test_jitter_follows_the_scenario():
    """Intervals of a stream spread by √2 σ of the generation times."""
    for scenario, tolerance in ((FEW_IMPORTANT, 0.03), (MIXED, 0.0003), (MOST_IMPORTANT, 1e-9)):
        spread = []
        for robot in range(10):
            times = [m.t_gen for m in mission(scenario, seed=1).messages if m.stream == robot]
            spread.append(np.std(np.diff(times)))
        assert np.mean(spread) == pytest.approx(2**0.5 * scenario.jitter, abs=tolerance)


def test_larger_teams_repeat_the_weights():
    """Robot 12 weighs what robot 2 weighs, so that a hundred robots have finite weights."""
    drawn = mission(FEW_IMPORTANT, seed=0, seconds=3.0, robots=100)
    assert {m.scale for m in drawn.messages if m.stream == 12} == {27.0}
    assert max(m.scale for m in drawn.messages) == 3.0**10
