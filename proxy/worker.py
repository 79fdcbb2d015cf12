"""Searches on a thread of its own, under the clock that the core does not have."""

import math
import threading
from collections.abc import Callable
from dataclasses import replace
from queue import SimpleQueue

from planner import SearchSettings, start
from proxy import clock
from proxy.core.commands import Decide
from proxy.core.events import DecisionReady

CHUNK = 25
"""Iterations between two looks at the clock."""
STUCK = 2.0
"""A decision that takes this much longer than it may will never end [s]."""


def decide(command: Decide, settings: SearchSettings, deadline: float) -> DecisionReady:
    """Search until the iterations are done, the decision is certain, or `deadline` [s] has passed.

    One iteration runs in any case: without it nothing is decided.
    """
    began = clock.monotonic()
    until = began + deadline
    try:
        search = start(command.problem, settings, command.seed)
        search.run(min(1, command.iterations))
        while not search.done and search.iterations < command.iterations and clock.monotonic() < until:
            search.run(min(CHUNK, command.iterations - search.iterations))
        plan, now = search.plan(), clock.monotonic()
        return DecisionReady(now, command.ticket, replace(plan, seconds=now - began))
    except Exception as error:  # noqa: BLE001 - whatever fails in there, the core must learn of it and fall back
        return DecisionReady(clock.monotonic(), command.ticket, None, f"{type(error).__name__}: {error}")


class Worker:
    """Answers one `Decide` after the other."""

    def __init__(self, settings: SearchSettings, deadline: float, post: Callable[[DecisionReady], None]) -> None:
        self._settings = settings
        self._deadline = deadline
        self._post = post
        self._orders: SimpleQueue[Decide | None] = SimpleQueue()
        self._began = math.inf
        self._thread = threading.Thread(target=self._run, name="planner", daemon=True)

    def start(self) -> None:
        """Start answering."""
        self._thread.start()

    def close(self, timeout: float) -> None:
        """Stop after the decision in hand; wait for it at most `timeout` [s]."""
        self._orders.put(None)
        self._thread.join(timeout)

    def submit(self, command: Decide) -> None:
        """Answer `command` when its turn comes."""
        self._orders.put(command)

    def stuck(self, now: float) -> bool:
        """Whether the decision in hand does not come to its end."""
        return now > self._began + self._deadline + STUCK

    def _run(self) -> None:
        while (command := self._orders.get()) is not None:
            self._began = clock.monotonic()
            self._post(decide(command, self._settings, self._deadline))
            self._began = math.inf
