"""Decisions under the clock that the core does not have, and a thread for those that take long."""

import math
import threading
from collections.abc import Callable
from dataclasses import replace
from queue import Empty, SimpleQueue

from planner import Search, SearchSettings, start
from proxy import clock
from proxy.core.interface.commands import Decide
from proxy.core.interface.events import DecisionReady
from proxy.tuning import TUNING


class Decision:
    """One decision in the making, on one thread at a time.

    It ends when the iterations are done, the answer is certain, or most of the `deadline` [s] has passed, which counts
    from when the decision was asked for. One iteration runs in any case: without it nothing is decided.
    """

    def __init__(self, command: Decide, settings: SearchSettings, deadline: float) -> None:
        self.command = command
        self.answer: DecisionReady | None = None
        """What was found, once it is made."""
        self._settings = settings
        self._until = command.asked + TUNING.search_part * deadline
        self._search: Search | None = None
        self._searched = 0.0
        """How long it has searched [s]."""

    def work(self, until: float = math.inf) -> DecisionReady | None:
        """Search until the decision ends, and return the answer; None where it does not by `until` [s]."""
        try:
            search = self._search = self._search or self._started()
            if self._ends(search, until):
                self.answer = self._made(search)
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # noqa: BLE001 - whatever fails in there, the core must learn of it and fall back
            text = f"{type(error).__name__}: {error}"
            self.answer = DecisionReady(clock.monotonic(), self.command.ticket, None, text)
        return self.answer

    def _started(self) -> Search:
        command = self.command
        search = start(command.problem, self._settings, command.seed)
        search.run(min(1, command.iterations))
        return search

    def _ends(self, search: Search, until: float) -> bool:
        """Search until the decision ends or so long [s]; whether it ends."""
        most, until = self.command.iterations, min(until, self._until)
        began = now = clock.monotonic()
        while not search.done and search.iterations < most and now < until:
            search.run(min(TUNING.iterations, search.iterations, most - search.iterations))
            now = clock.monotonic()
        self._searched += now - began
        return search.done or search.iterations >= most or now >= self._until

    def _made(self, search: Search) -> DecisionReady:
        """Return the best plan found so far."""
        command = self.command
        plan, now = search.plan(), clock.monotonic()
        took, cut = now - command.asked, not search.done and search.iterations < command.iterations
        plan = replace(plan, seconds=took)
        return DecisionReady(now, command.ticket, plan, overhead=took - self._searched, cut=cut)


class Worker:
    """Goes on with each decision unless a newer one came before its turn: the core does not wait for an older one."""

    def __init__(self, deadline: float, post: Callable[[DecisionReady], None]) -> None:
        self._deadline = deadline
        self._post = post
        self._orders: SimpleQueue[Decision | None] = SimpleQueue()
        self._began = math.inf
        self._thread = threading.Thread(target=self._run, name="planner", daemon=True)

    def close(self, timeout: float) -> None:
        """Stop after the decision in hand; wait for it at most `timeout` [s]."""
        self._orders.put(None)
        if self._thread.ident is not None:
            self._thread.join(timeout)

    def submit(self, decision: Decision) -> None:
        """Go on with `decision` when its turn comes, and post its answer. From one thread at a time."""
        self._orders.put(decision)
        if self._thread.ident is None:  # few daemons need it
            self._thread.start()

    def busy(self, now: float) -> bool:
        """Whether the decision in hand is overdue: nothing that is submitted now will be answered soon."""
        return now > self._began + self._deadline

    def stuck(self, now: float) -> bool:
        """Whether the decision in hand does not come to its end."""
        return now > self._began + self._deadline + TUNING.stuck_after

    def _run(self) -> None:
        while (decision := self._newest()) is not None:
            self._began = decision.command.asked
            if (answer := decision.work()) is not None:
                self._post(answer)
            self._began = math.inf

    def _newest(self) -> Decision | None:
        """Wait for an order; return the last one of those that wait."""
        order = self._orders.get()
        while order is not None:
            try:
                order = self._orders.get_nowait()
            except Empty:
                break
        return order
