"""The one thread on which the core runs: events in, commands out, time passing."""

import logging
import threading
from collections.abc import Callable
from queue import Empty, SimpleQueue

from proxy import clock
from proxy.core.commands import Command
from proxy.core.core import Core
from proxy.core.events import Event, TimePassed

log = logging.getLogger(__name__)

Item = Event | Callable[[], Event | None]
"""An event, or a job for the loop's thread that may make one."""


class Loop:
    """Feeds the core. `execute` carries out each command, on this thread: it must not block."""

    def __init__(self, core: Core, execute: Callable[[Command], None]) -> None:
        self.core = core
        self.faults = 0
        """Events that the core could not digest."""
        self._execute = execute
        self._items: SimpleQueue[Item | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="loop", daemon=True)

    def start(self) -> None:
        """Start feeding."""
        self._thread.start()

    def close(self, timeout: float) -> None:
        """Stop after the events that wait already; wait for it at most `timeout` [s]."""
        self._items.put(None)
        self._thread.join(timeout)

    def post(self, item: Item) -> None:
        """Let the core know. From any thread; never blocks."""
        self._items.put(item)

    @property
    def waiting(self) -> int:
        """Items that wait for the core."""
        return self._items.qsize()

    def handle(self, event: Event) -> None:
        """Take in `event` and carry out what follows. On the loop's thread only."""
        for command in self.core.handle(event):
            self._execute(command)

    def _run(self) -> None:
        wake_at = clock.monotonic()
        while (item := self._next(wake_at)) is not None:
            wake_at = self._digest(item)

    def _next(self, wake_at: float) -> Item | None:
        try:
            return self._items.get(timeout=max(wake_at - clock.monotonic(), 0.0))
        except Empty:
            return TimePassed(clock.monotonic())

    def _digest(self, item: Item) -> float:
        """Handle one item; return when time must pass next."""
        try:
            event = item() if callable(item) else item
            if event is not None:
                self.handle(event)
            return self.core.wake_at(clock.monotonic())
        except Exception:
            self.faults += 1
            log.exception("the core cannot handle %s", type(item).__name__)
            return clock.monotonic() + 0.1
