"""Searches on a thread of its own, under the clock that the core does not have."""

import math
import threading
from collections.abc import Callable
from dataclasses import replace
from queue import Empty, SimpleQueue

from planner import SearchSettings, start
from proxy import clock
from proxy.core.interface.commands import Decide
from proxy.core.interface.events import DecisionLate, DecisionReady
from proxy.tuning import TUNING


def decide(command: Decide, settings: SearchSettings, deadline: float) -> DecisionReady:
    """Search until the iterations are done, the decision is certain, or most of the `deadline` [s] has passed.

    It counts from when the decision was asked for. One iteration runs in any case: without it nothing is decided.
    """
    until = command.asked + TUNING.search_part * deadline
    try:
        search = start(command.problem, settings, command.seed)
        search.run(min(1, command.iterations))
        began = now = clock.monotonic()
        while not search.done and search.iterations < command.iterations and now < until:
            search.run(min(TUNING.iterations, search.iterations, command.iterations - search.iterations))
            now = clock.monotonic()
        searched, plan, now = now - began, search.plan(), clock.monotonic()
        took, cut = now - command.asked, not search.done and search.iterations < command.iterations
        return DecisionReady(now, command.ticket, replace(plan, seconds=took), overhead=took - searched, cut=cut)
    except Exception as error:  # noqa: BLE001 - whatever fails in there, the core must learn of it and fall back
        return DecisionReady(clock.monotonic(), command.ticket, None, f"{type(error).__name__}: {error}")


class Worker:
    """Answers each `Decide` unless a newer one came before its turn: the core does not wait for an older one then."""

    def __init__(self, settings: SearchSettings, deadline: float, post: Callable[[DecisionReady], None]) -> None:
        self._settings = settings
        self._deadline = deadline
        self._post = post
        self._orders: SimpleQueue[Decide | None] = SimpleQueue()
        self._began = math.inf
        self._answer: DecisionReady | None = None
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

    def due(self, ticket: int) -> DecisionReady | DecisionLate:
        """Return the answer to this decision, which may still be on its way, or that there is none by its deadline."""
        answer = self._answer
        return answer if answer is not None and answer.ticket == ticket else DecisionLate(clock.monotonic(), ticket)

    def busy(self, now: float) -> bool:
        """Whether the decision in hand is overdue: nothing that is submitted now will be answered soon."""
        return now > self._began + self._deadline

    def stuck(self, now: float) -> bool:
        """Whether the decision in hand does not come to its end."""
        return now > self._began + self._deadline + TUNING.stuck_after

    def _run(self) -> None:
        while (command := self._newest()) is not None:
            self._began = command.asked
            self._answer = decide(command, self._settings, self._deadline)
            self._post(self._answer)
            self._began = math.inf

    def _newest(self) -> Decide | None:
        """Wait for an order; return the last one of those that wait."""
        order = self._orders.get()
        while order is not None:
            try:
                order = self._orders.get_nowait()
            except Empty:
                break
        return order
