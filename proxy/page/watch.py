"""The page's own place on the mesh: behind a daemon, like any application of an operator."""

import threading
from collections.abc import Callable, Sequence
from contextlib import ExitStack, suppress
from dataclasses import asdict
from typing import Any

import zenoh

from proxy.commands.client import Client, NoAnswerError, connected
from proxy.page import demo
from proxy.page.specs import InForce
from proxy.page.tuning import TUNING


class Watch:
    """Hands what robots publish to `take`, on threads of Zenoh; looks after specs and the demo on a thread of its own.

    It subscribes to `keys`; without any to those that the specs in force cover, which is what robots plan for.
    """

    def __init__(
        self, endpoint: str, robot: str | None, keys: Sequence[str], take: Callable[[zenoh.Sample], object]
    ) -> None:
        self.robot = robot or ""
        """The robot through whose daemon the page looks; empty while unknown."""
        self.in_force = InForce()
        self.demo: dict[str, Any] | None = None
        """What a demo says of its world; None: there is none."""
        self.problem = ""
        """Why the page does not know through whose daemon it looks, or that one does not answer."""
        self._endpoint = endpoint
        self._wanted = robot
        self._keys = tuple(keys)
        self._take = take
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name="page")

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """End; a daemon that is being asked has its time to answer."""
        self._stopped.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._stopped.is_set():
            try:
                with connected(self._endpoint) as client:
                    self._follow(client)
            except (NoAnswerError, zenoh.ZError) as error:
                self.problem = str(error)
                self._stopped.wait(TUNING.look)

    def _follow(self, client: Client) -> None:
        """Listen until the daemon does not answer any more. Raises NoAnswerError."""
        with ExitStack() as listening:
            heard: tuple[str, ...] = ()
            while not self._stopped.is_set():
                self.robot = self._wanted or client.only_robot()
                generation, files = client.specs(self.robot)
                if self.in_force.passing or (generation, files) != (self.in_force.generation, self.in_force.files):
                    self.in_force = InForce.of(generation, files)
                keys = self._keys or tuple(dict.fromkeys(k for each in self.in_force.specs.types for k in each.keys))
                if keys != heard:
                    listening.close()
                    listening.enter_context(client.listening(keys, self._take))
                    heard = keys
                self.problem = ""
                self.demo = _demo(client)
                self._stopped.wait(TUNING.look)


def _demo(client: Client) -> dict[str, Any] | None:
    """Ask a demo, if there is one, what can be done to its world. Any application may answer in its place, anything."""
    found: dict[str, Any] = {}
    with suppress(NoAnswerError, demo.DemoOrderError):
        found["channel"] = asdict(demo.Channel.read(client.ask(demo.CHANNEL).encode()))
    with suppress(NoAnswerError, demo.DemoOrderError):
        found["red"] = {"robots": demo.read_robots(client.ask(demo.RED).encode())}
    return found or None
