"""Links that fall and come back."""

import time

import pytest

from tests.faults.scene import Fault
from tests.waiting import wait_until

pytestmark = pytest.mark.full
FLAPS = 10


class Severed(Fault):
    """No link between some robots any more, as by a wall: each end is told."""

    def __init__(self, scene, *ends):
        self._relays = [scene.relays[each] for each in ends]

    def start(self):
        for relay in self._relays:
            relay.cut()

    def stop(self):
        for relay in self._relays:
            relay.mend()


def test_a_link_that_flaps_costs_what_is_sent_meanwhile(play):
    """Again and again, before either end has got used to it: afterwards samples cross as ever, each once."""
    scene = play(relays=True)
    for number in range(FLAPS):
        with Severed(scene, "ab"):
            pass
        if number % 3 == 0:
            scene.go_on()
    began = time.monotonic()
    scene.go_on()
    scene.meet()
    print(f"right again {time.monotonic() - began:.2f} s after the last of {FLAPS} flaps")
    scene.finish()


def test_parts_of_a_team_work_alone_and_merge(play):
    """One of three robots is alone: all know who is there, each part goes on; then all have one view again."""
    scene = play(names="abc", relays=True)
    a, b, c = scene.robots.values()
    with Severed(scene, "ac", "bc"):
        wait_until(lambda: (a.peers(), b.peers(), c.peers()) == ({"b"}, {"a"}, set()), 30.0, "both parts")
        scene.go_on(listeners=[scene.local, scene.remote[0]])
        heard = scene.remote[1].last
    began = time.monotonic()
    scene.meet()
    scene.go_on()
    print(f"one team again after {time.monotonic() - began:.2f} s")
    for robot in (b, c):
        wait_until(lambda robot=robot: of_a(robot) == of_a(a), what="one view")
    missed = [number for number in range(heard + 1) if number not in set(scene.remote[0].heard)]
    assert len(missed) < 50, "the part that stayed together lost samples"
    scene.finish()


def of_a(robot):
    """Which streams of `a` a robot knows."""
    return [stream["key"] for stream in robot.status()["streams"] if stream["robot"] == "a"]
