"""Hands events to the core and carries out what follows, on one thread at a time."""

import logging
from collections.abc import Callable

from proxy import clock
from proxy.agenda import Item
from proxy.core.core import Core
from proxy.core.interface.commands import Command
from proxy.core.interface.events import ClockChanged, Event, Taker
from proxy.preparing import Preparation
from proxy.tuning import TUNING

log = logging.getLogger(__name__)


class Feed:
    """`execute` carries out each command: it must not block.

    While it is synchronised the wall clock is wrong by `clock_error` at most [s]; 0.0: that is not known.
    """

    def __init__(self, core: Core, execute: Callable[[Command], None], clock_error: float) -> None:
        self.core = core
        self.faults = 0
        """Events that the core could not digest."""
        self.notes = False
        """Whether there is nothing for which the core needs to know at once of what it only notes."""
        self.preparation = Preparation()
        self._execute = execute
        self._taker: Taker = core
        self._wall = clock.WallWatch(core.view.clocks.offset, clock_error)

    def record(self, taker: Taker | None) -> None:
        """Have `taker` hand events to the core from now on; None: nobody, they go to it."""
        self._taker = self.core if taker is None else taker

    def handle(self, event: Event) -> None:
        """Take in `event` and carry out what follows."""
        for command in self._taker.handle(event):
            self._execute(command)

    def pass_on(self, event: Event) -> bool:
        """Have the core take in a sample if it only has to be sent on, and send it; return whether it did."""
        commands = self._taker.pass_on(event)
        if commands is None:
            return False
        for command in commands:
            self._execute(command)
        return True

    def passes(self, item: object) -> bool:
        """Have the core take in what follows a sample, if that asks for nothing else; return whether it did."""
        return isinstance(item, Event) and self._taker.pass_on(item) == []

    def digest(self, item: Item) -> float:
        """Handle one item; return when time must pass next [s]."""
        try:
            event = item() if callable(item) else item
            if event is not None:
                self.handle(event)
            self.preparation.follow(self.core)
            now = clock.monotonic()
            wall = self._wall.look(now)
            if wall is not None:
                self.handle(ClockChanged(now, wall.offset, wall.error))
            self.notes = self.core.notes
            return self.core.wake_at(now)
        except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever fails in there
            self.fail(item, error)
            return clock.monotonic() + TUNING.after_fault

    def fail(self, item: Item, error: BaseException) -> None:
        """The core could not handle this."""
        self.faults += 1
        log.error("the core cannot handle %s", type(item).__name__, exc_info=error)
