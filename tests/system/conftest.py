"""A channel of its own for every test, and robots on it."""

from contextlib import ExitStack

import pytest

from tests.system.network import RADIO, Network
from tests.system.robots import Robot, wait_until_met
from tests.waiting import wait_until


@pytest.fixture
def network(tmp_path):
    """A channel without hosts."""
    with ExitStack() as closing:
        place = tmp_path / "mount"
        place.mkdir()
        made = Network(place)
        closing.callback(made.close)
        yield made


@pytest.fixture
def start(network, tmp_path):
    """Start a robot on a host of its own; it ends with the test."""
    with ExitStack() as closing:

        def start_one(name, *, limit="2 Mbit/s", interface=RADIO, app="", mesh="", host=None):
            folder = tmp_path / name
            folder.mkdir()
            robot = Robot(host or network.add(name), folder, limit=limit, interface=interface, app=app, mesh=mesh)
            closing.callback(robot.close)
            return robot

        yield start_one


@pytest.fixture
def team(start):
    """Start three robots at once and wait until each knows the others."""

    def start_all(**options):
        robots = [start(name, **options) for name in ("a", "b", "c")]
        for robot in robots:
            wait_until(robot.serves, what=f"start of {robot.name}")
        wait_until_met(robots)
        return robots

    return start_all
