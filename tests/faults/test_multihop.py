"""Robots out of each other's range, with one between them that forwards IP, as a routing protocol would have it."""

import os
import subprocess

import pytest

from tests.faults.scene import Fault
from tests.system.network import RADIO, Host, ip, sweep
from tests.system.robots import Robot, wait_until_met
from tests.waiting import wait_until

pytestmark = pytest.mark.system
OTHER_RADIO = "wlan1"


def runs(host, interface):
    """Whether the kernel says that an interface does."""
    return host.run("cat", f"/sys/class/net/{interface}/operstate").stdout.strip() == "up"


class Chain:
    """Hosts a, b and c: b is in the range of both others, on two channels. Needs root."""

    def __init__(self, place):
        sweep()
        air = f"sendworthy-{os.getpid()}-hops"
        addresses = {"a": "10.79.1.1", "b": "10.79.1.2", "c": "10.79.2.1"}
        self.a, self.b, self.c = self.hosts = [Host(*each, air, place) for each in addresses.items()]
        for host in self.hosts:
            ip("netns", "add", host.namespace)
            ip("-n", host.namespace, "link", "set", "dev", "lo", "up")
        self._join(self.a, "10.79.1.1", self.b, RADIO, "10.79.1.2")
        self._join(self.c, "10.79.2.1", self.b, OTHER_RADIO, "10.79.2.2")
        self.b.run("sh", "-c", "echo 1 > /proc/sys/net/ipv4/ip_forward")
        # The kernel may take a second to say so; a daemon looks for others where interfaces run when it starts.
        for host, name in ((self.a, RADIO), (self.b, RADIO), (self.b, OTHER_RADIO), (self.c, RADIO)):
            wait_until(lambda host=host, name=name: runs(host, name), what=f"{name} of {host.name} to run")
        ip("-n", self.a.namespace, "route", "add", "default", "via", "10.79.1.2")
        ip("-n", self.c.namespace, "route", "add", "default", "via", "10.79.2.2")

    def _join(self, end, address, middle, interface, other):
        peer = ("peer", "name", interface, "netns", middle.namespace)
        ip("-n", end.namespace, "link", "add", "name", RADIO, "type", "veth", *peer)
        for host, name, own in ((end, RADIO, address), (middle, interface, other)):
            ip("-n", host.namespace, "address", "add", f"{own}/24", "dev", name)
            ip("-n", host.namespace, "link", "set", "dev", name, "up")

    def close(self):
        for host in self.hosts:
            subprocess.run(["ip", "netns", "delete", host.namespace], check=False)


class Unrouted(Fault):
    """The robot in the middle forwards nothing any more; it still reaches both others."""

    def __init__(self, host):
        self._host = host

    def start(self):
        self._host.run("sh", "-c", "echo 0 > /proc/sys/net/ipv4/ip_forward")

    def stop(self):
        self._host.run("sh", "-c", "echo 1 > /proc/sys/net/ipv4/ip_forward")


def test_robots_two_hops_apart_are_a_team(tmp_path, stack):
    """They find each other by what the middle one tells; a lost route parts them, and they meet again."""
    place = tmp_path / "mount"
    place.mkdir()
    chain = Chain(place)
    stack.callback(chain.close)
    robots = []
    for host in chain.hosts:
        folder = tmp_path / host.name
        folder.mkdir()
        robots.append(Robot(host, folder, limit="2 Mbit/s", interface="auto"))
        stack.callback(robots[-1].close)
    for robot in robots:
        wait_until(robot.serves, what=f"start of {robot.name}")
    wait_until_met(robots)
    a, b, c = robots
    heard, local = c.hear("robot/a/camera"), a.hear("robot/a/camera")
    at_b = b.hear("robot/a/camera")
    a.wait_wanted("robot/a/camera")
    speaker = a.say("robot/a/camera", size=1000, rate=50)
    wait_until(lambda: heard.numbers("robot/a/camera"), what="samples over two hops")
    with Unrouted(chain.b):
        wait_until(lambda: (a.peers(), c.peers()) == ({"b"}, {"b"}), 30.0, "the loss to be noticed")
        before = len(at_b.numbers("robot/a/camera"))
        wait_until(lambda: len(at_b.numbers("robot/a/camera")) > before + 20, what="samples over one hop")
    wait_until_met(robots, 30.0)
    before = len(heard.numbers("robot/a/camera"))
    wait_until(lambda: len(heard.numbers("robot/a/camera")) > before + 20, 30.0, "samples over two hops again")
    total = speaker.stop()
    wait_until(lambda: local.numbers("robot/a/camera") == list(range(total)), what="all samples on the robot itself")
    for listener in (heard, at_b):
        numbers = listener.numbers("robot/a/camera")
        assert numbers == sorted(set(numbers))
    assert all(robot.status()["counts"]["conserved"] for robot in robots)
