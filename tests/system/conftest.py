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

        def start_one(name, *, limit="2 Mbit/s", interface=RADIO, host=None, ipv6=True, **options):
            folder = tmp_path / name
            folder.mkdir()
            host = host or network.add(name)
            if not ipv6:
                host.lose_ipv6()
            robot = Robot(host, folder, limit=limit, interface=interface, **options)
            closing.callback(robot.close)
            return robot

        yield start_one


@pytest.fixture
def team(start):
    """Start robots at once, three unless others are named, and wait until each knows the others."""

    def start_all(names="abc", **options):
        robots = [start(name, **options) for name in names]
        for robot in robots:
            wait_until(robot.serves, what=f"start of {robot.name}")
        wait_until_met(robots)
        return robots

    return start_all
