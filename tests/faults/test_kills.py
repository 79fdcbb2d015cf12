"""Daemons are killed under load, one after the other."""

import os
import statistics
import time

import pytest

from tests.faults.scene import Fault
from tests.waiting import wait_until

pytestmark = pytest.mark.full
KILLS = int(os.environ.get("KILLS", "4"))
"""How often; the long run has a hundred."""


class Killed(Fault):
    """A daemon dies as in a power cut, and is started again at once."""

    def __init__(self, robot):
        self._robot = robot

    def start(self):
        self._robot.end()

    def stop(self):
        self._robot.start()


def test_kills_cost_a_moment_and_nothing_twice(play):
    """Who publishes and who hears by turns: samples come again soon, in order, each once; losses are counted exactly."""
    scene = play()
    robots, times, lost = list(scene.robots.values()), [], []
    for number in range(KILLS):
        heard, said = len(scene.remote[0].heard), scene.speaker.said
        began = time.monotonic()
        with Killed(robots[number % 2]):
            pass
        started, latest = time.monotonic() - began, scene.remote[0].last
        wait_until(lambda latest=latest: scene.remote[0].last > latest, 30.0, "a first sample")
        times.append(time.monotonic() - began - started)
        scene.go_on()
        missed = scene.speaker.said - said - (len(scene.remote[0].heard) - heard)
        lost.append(missed)
        scene.meet()
    print(f"{KILLS} kills: first sample after the start {statistics.median(times):.2f} s, longest {max(times):.2f} s")
    print(f"samples lost in each, of 50 a second: {lost}")
    scene.finish(whole_local=False, counted=False)
    assert scene.speaker.said - len(scene.remote[0].heard) < KILLS * 50 * 10
