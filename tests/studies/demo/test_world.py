"""The world in which the demo's robots drive."""

import math
from itertools import pairwise

import numpy as np
import pytest

from studies.demo.world import CLOSEST, SPEED, Episode, World, moment, phases, schedule

ROBOTS, SECONDS, PERIOD = 4, 30.0, 0.1


@pytest.mark.parametrize("robots", [1, 8, 16])
def test_robots_drive_ahead_at_their_speed(robots):
    """They move where they look."""
    world = World(1, robots)
    for robot in range(robots):
        before, after = world.pose(robot, 10.0), world.pose(robot, 10.1)
        way = (after.x - before.x, after.y - before.y)
        assert math.hypot(*way) == pytest.approx(0.1 * SPEED, rel=0.01)
        ahead = way[0] * math.cos(before.heading) + way[1] * math.sin(before.heading)
        assert ahead == pytest.approx(math.hypot(*way), rel=0.01)


def test_an_object_stands_ahead_until_its_robot_is_close():
    """It stays where it is, and the robot comes."""
    world, episode = World(1, ROBOTS), Episode(2, 10.0, 15.0)
    x, y = world.place(episode)
    far, near = (math.dist((x, y), world.pose(2, t)[:2]) for t in (10.0, 15.0))
    assert near == pytest.approx(CLOSEST)
    assert far == pytest.approx(CLOSEST + 5.0 * SPEED, rel=0.1)


@pytest.mark.parametrize("seed", range(20))
def test_one_robot_at_a_time_meets_something_red(seed):
    """Episodes last 3 to 6 s, do not overlap, and do not favour one robot twice running."""
    episodes = schedule(seed, ROBOTS, SECONDS)
    assert len(episodes) >= 3
    assert all(3.0 <= e.end - e.start <= 6.0 for e in episodes)
    for before, after in pairwise(episodes):
        assert after.start - before.end >= 1.0
        assert after.robot != before.robot


def test_a_lonely_robot_meets_something_red_too():
    """With one robot every episode is its own."""
    assert {episode.robot for episode in schedule(1, 1, SECONDS)} == {0}


def test_cameras_do_not_click_together():
    """Phases are spread over the period."""
    times = sorted(phases(1, ROBOTS, PERIOD))
    assert times[0] >= 0.0
    assert times[-1] < PERIOD
    assert min(np.diff(times)) > PERIOD / ROBOTS / 4


def test_the_moment_lies_late_in_the_last_episode_that_was_long_enough():
    """Red had time to reach the screen, and still is in view."""
    episodes = [Episode(0, 1.0, 5.0), Episode(1, 7.0, 11.0), Episode(2, 13.0, 17.0)]
    assert moment(episodes, 30.0) == pytest.approx(16.7)
    assert moment(episodes, 14.0) == pytest.approx(10.7)
    assert moment([], 10.0) == pytest.approx(9.0)
