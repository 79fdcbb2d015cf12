"""Daemons, applications, robots and links vanish and return in any order, and all is as it was."""

import os
import random

import pytest

from tests.system.robots import wait_until_met
from tests.waiting import wait_until

pytestmark = pytest.mark.system

KILLS = int(os.environ.get("KILLS", "4"))
"""How much is lost one after the other; the long run has hundreds."""
SOON = 30.0
"""A lost robot is noticed after 2 s; daemons start in one, and two cores run all of it [s]."""


class Scene:
    """Two robots: `a` has an application that serves, `b` one that watches."""

    def __init__(self, start):
        self.robots = {name: start(name) for name in ("a", "b")}
        for robot in self.robots.values():
            wait_until(robot.serves, what=f"start of {robot.name}")
        wait_until_met(list(self.robots.values()))
        self.watcher = self.robots["b"].watch()
        self.service = self.robots["a"].serve("a")
        self.expect_all()

    def kill(self, name):
        self.robots[name].kill()

    def restart(self, name):
        self.robots[name].start()
        wait_until(self.robots[name].serves, what=f"start of {name}")

    def expect_all(self):
        """Everything of the service is there for the watcher: new samples, its token, one answer to each question."""
        heard, asked = len(self.watcher.samples()), len(self.watcher.rounds())

        def there():
            rounds = self.watcher.rounds()[asked + 1 :]
            return (
                len(self.watcher.samples()) > heard + 5
                and self.watcher.tokens() == {"alive/a"}
                and any(len(each["answers"]) == 1 and each["tokens"] == ["alive/a"] for each in rounds)
            )

        wait_until(there, SOON, "all of the service")

    def expect_nothing(self):
        """The token is gone, and nobody answers."""
        asked = len(self.watcher.rounds())

        def gone():
            rounds = self.watcher.rounds()[asked + 1 :]
            return not self.watcher.tokens() and any(not each["answers"] and not each["tokens"] for each in rounds)

        wait_until(gone, SOON, "the end of the service")

    def expect_each_once(self):
        """No sample was delivered twice, no question answered twice, and the order is that of publication."""
        samples = self.watcher.samples()
        assert len(samples) == len(set(samples))
        assert samples == sorted(samples, key=lambda text: [int(part) for part in text.split()])
        twice = [each for each in self.watcher.rounds() if len(each["answers"]) > 1 or len(each["tokens"]) > 1]
        assert not twice


@pytest.fixture
def scene(start):
    made = Scene(start)
    yield made
    made.expect_each_once()


@pytest.mark.parametrize("name", ["a", "b"])
def test_a_killed_daemon_costs_nothing_but_time(scene, name):
    """Applications come back to it by themselves, and what they declared is declared again."""
    scene.kill(name)
    scene.restart(name)
    scene.expect_all()


@pytest.mark.parametrize("order", ["ab", "ba"])
def test_both_daemons_killed_come_back_in_any_order(scene, order):
    """Whoever is first waits for the other."""
    for name in order:
        scene.kill(name)
    for name in order:
        scene.restart(name)
    scene.expect_all()


def test_an_application_that_dies_leaves_nothing_and_its_successor_is_seen(scene):
    """Also when its daemon is killed between the two."""
    scene.service.close()
    scene.expect_nothing()
    scene.service = scene.robots["a"].serve("a")
    scene.expect_all()
    scene.service.close()
    scene.kill("a")
    scene.expect_nothing()
    scene.restart("a")
    scene.service = scene.robots["a"].serve("a")
    scene.expect_all()


def test_a_lost_link_takes_everything_with_it_and_brings_it_back(scene):
    """Out of range, and off, with the daemon restarted meanwhile."""
    host = scene.robots["a"].host
    host.range(within=False)
    scene.expect_nothing()
    host.range(within=True)
    scene.expect_all()
    host.radio("down")
    scene.expect_nothing()
    scene.kill("a")
    host.radio("up")
    scene.restart("a")
    scene.expect_all()


class Losses:
    """What can be lost of a scene: each is lost and comes back."""

    def __init__(self, scene):
        self._scene = scene

    def daemon_of_the_service(self):
        self._scene.kill("a")
        self._scene.restart("a")

    def daemon_of_the_watcher(self):
        self._scene.kill("b")
        self._scene.restart("b")

    def both_daemons(self):
        for name in "ab":
            self._scene.kill(name)
        for name in "ba":
            self._scene.restart(name)

    def application(self):
        self._scene.service.close()
        self._scene.service = self._scene.robots["a"].serve("a")

    def link(self):
        self._scene.robots["a"].host.range(within=False)
        self._scene.expect_nothing()
        self._scene.robots["a"].host.range(within=True)


def test_what_is_lost_one_after_the_other_comes_back_each_time(scene):
    """Daemons, an application, the link, in an order that is drawn, some while the one before still comes back."""
    draw, losses = random.Random(KILLS), Losses(scene)
    ways = [name for name in vars(Losses) if not name.startswith("_")]
    for _ in range(KILLS):
        way = draw.choice(ways)
        print(way, flush=True)
        getattr(losses, way)()
        if draw.random() < 0.7:
            scene.expect_all()
    scene.expect_all()
