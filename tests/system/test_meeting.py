"""Robots that meet at a router of the operator: everything goes through it, once."""

import time

import pytest

from tests.routers import Router
from tests.system.robots import Listener, wait_until_met
from tests.waiting import wait_until

pytestmark = pytest.mark.system

SIZE = 1000


@pytest.fixture
def base(network):
    """The host of the operator, with a router."""
    host = network.add("base")
    router = Router("tcp/0.0.0.0:7447", start=host.start)
    yield host
    router.kill()


@pytest.fixture
def robots(base, start):
    """Two robots that know nothing but the router."""
    mesh = f'mode = "client"\nconnect = ["tcp/{base.address}:7447"]'
    robots = [start(name, mesh=mesh) for name in ("a", "b")]
    for robot in robots:
        wait_until(robot.serves, what=f"start of {robot.name}")
    wait_until_met(robots)
    return robots


def test_a_sample_goes_up_once_and_arrives_once(base, robots, tmp_path):
    """For a robot and an operator that listen a sample leaves its robot once, and no robot has a link to another."""
    listeners = [robots[1].hear("a"), Listener(base, tmp_path / "operator", "hear", "a")]
    wait_until(listeners[1].ready, what="the operator")
    speaker = robots[0].say("a", size=SIZE, rate=100)
    for listener in listeners:
        wait_until(lambda listener=listener: listener.numbers("a"), what="a sample")
    before, first = robots[0].host.sent(), listeners[0].numbers("a")[-1]
    wait_until(lambda: listeners[0].numbers("a")[-1] > first + 300, what="300 samples")
    copies = (robots[0].host.sent() - before) / SIZE / (listeners[0].numbers("a")[-1] - first)
    print(f"{copies:.2f} copies on the way up")
    assert copies < 1.5
    for robot in robots:
        assert all(theirs == 7447 for _, theirs in robot.host.links())
    total = speaker.stop()
    for listener in listeners:
        wait_until(lambda listener=listener: listener.numbers("a")[-1] == total - 1, what="the last sample")
        heard = listener.numbers("a")
        assert heard == list(range(heard[0], total))
    listeners[1].close()


def test_a_robot_that_vanishes_is_gone_and_comes_back(robots):
    """As on a mesh of peers."""
    robots[1].host.radio("down")
    lost = time.monotonic()
    wait_until(lambda: not robots[0].peers(), 30, "the other to be gone")
    print(f"gone {time.monotonic() - lost:.2f} s after")
    robots[1].host.radio("up")
    wait_until_met(robots, 30)
