"""What the demo's cameras see."""

import math

import cv2
import numpy as np
import pytest

from studies.demo.scene import HEIGHT, PERIOD, RED, WIDTH, Scene, red_fraction
from studies.demo.world import Episode, World, phases, schedule
from utility_specs.features.color_fraction import ColorFraction
from utility_specs.features.sample import Sample

ROBOTS, SECONDS = 4, 30.0


def scene(robot, seed=1, episodes=None):
    if episodes is None:
        episodes = schedule(seed, ROBOTS, SECONDS)
    return Scene(seed, robot, ROBOTS, episodes)


def seen(view, robot, t):
    """The frame of a time."""
    return view.frame(round((t - phases(1, ROBOTS, PERIOD)[robot]) / PERIOD))


@pytest.mark.parametrize("robot", range(ROBOTS))
def test_a_red_object_is_red_as_long_as_it_stands_in_a_robots_way(robot):
    """From its first frame to its last one, and not before or after."""
    view = scene(robot, episodes=[Episode(robot, 5.0, 10.0)])
    assert seen(view, robot, 4.8).red < RED
    assert all(seen(view, robot, t).red >= RED for t in (5.1, 7.5, 9.8))
    assert seen(view, robot, 9.8).red < 0.5
    assert seen(view, robot, 10.2).red < RED


def test_who_looks_elsewhere_does_not_see_it():
    """An object is in the way of one robot, and in the view of those that look at it only."""
    view = scene(0, episodes=[Episode(0, 5.0, 10.0)])
    world = World(1, ROBOTS)
    x, y = world.place(Episode(0, 5.0, 10.0))
    behind = [
        robot
        for robot in range(1, ROBOTS)
        for pose in [world.pose(robot, 7.5)]
        if (x - pose.x) * math.cos(pose.heading) + (y - pose.y) * math.sin(pose.heading) < 0
    ]
    assert seen(view, 0, 7.5).red >= RED
    assert behind
    for robot in behind:
        alone = scene(robot, episodes=[])
        assert seen(scene(robot, episodes=[Episode(0, 5.0, 10.0)]), robot, 7.5) == seen(alone, robot, 7.5)


def test_an_object_that_is_put_there_later_is_seen():
    """As one that was there by the schedule."""
    planned, told = scene(1, episodes=[Episode(1, 5.0, 10.0)]), scene(1, episodes=[])
    told.add(Episode(1, 5.0, 10.0))
    assert seen(told, 1, 6.0) == seen(planned, 1, 6.0)


@pytest.mark.parametrize("robot", range(ROBOTS))
def test_frames_have_the_size_of_a_cameras(robot):
    """30 to 40 kB."""
    view = scene(robot)
    assert all(30_000 <= len(view.frame(number).jpeg) <= 40_000 for number in range(0, 300, 30))


@pytest.mark.full
def test_wheels_are_red_and_no_object():
    """Robots that meet see some red, but less than of an object."""
    views = [scene(robot, episodes=[]) for robot in range(ROBOTS)]
    reds = [view.frame(number).red for view in views for number in range(0, 1200, 60)]
    assert max(reds) > 0.003
    assert max(reds) < RED


@pytest.mark.full
def test_the_daemon_measures_the_red_that_is_said():
    """The feature of a spec finds it in the JPEG."""
    feature = ColorFraction("red")
    for robot in range(ROBOTS):
        view = scene(robot)
        for number in range(0, 300, 60):
            frame = view.frame(number)
            image = cv2.imdecode(np.frombuffer(frame.jpeg, np.uint8), cv2.IMREAD_COLOR)
            assert image.shape == (HEIGHT, WIDTH, 3)
            assert feature.measure(Sample("robot/r1/camera", frame.jpeg)) == pytest.approx(frame.red, abs=0.01)


def test_red_is_counted_by_colour():
    """A quarter of the image."""
    image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    image[: HEIGHT // 2, : WIDTH // 2] = (20, 20, 220)
    assert red_fraction(image) == pytest.approx(0.25)


def test_the_scene_is_the_same_twice_and_moves():
    """A frame is a function of seed, robot and number."""
    first, second = scene(0), scene(0)
    assert first.frame(7) == second.frame(7)
    assert first.frame(7).jpeg != first.frame(8).jpeg
    assert first.frame(7).jpeg != scene(0, seed=2).frame(7).jpeg


def test_sixteen_robots_have_a_view():
    """As many as the demo has at most."""
    assert len(Scene(1, 15, 16, ()).frame(0).jpeg) > 20_000
