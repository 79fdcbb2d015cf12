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
    """Who publishes and who hears by turns: samples come again soon, each once; what was said meanwhile is lost."""
    scene = play(key="plain/a")  # nothing decides on it: all that is lost the kills have cost
    robots, times, windows = list(scene.robots.values()), [], []
    heard = scene.remote[0]
    for number in range(KILLS):
        begins = heard.last
        with Killed(robots[number % 2]):
            pass
        began = time.monotonic()
        latest = heard.last
        wait_until(lambda latest=latest: heard.last > latest, 30.0, "a first sample")
        times.append(time.monotonic() - began)
        scene.go_on()
        windows.append(range(begins + 1, heard.last))
        scene.meet()
    said = scene.stop()
    wait_until(lambda: heard.last == said - 1, what="the last sample")
    lost = set(range(heard.heard[0], said)) - set(heard.heard)
    assert not [number for number in lost if not any(number in window for window in windows)]
    scene.finish(whole_local=False, counted=False)
    each = [sum(number in lost for number in window) for window in windows]
    print(f"{KILLS} kills: first sample after the start {statistics.median(times):.2f} s, longest {max(times):.2f} s")
    print(f"lost of 50 samples a second: {statistics.median(each):.0f} in each, most {max(each)}, {len(lost)} in all")
