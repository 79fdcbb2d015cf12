"""The one thread on which the core runs: events in, commands out, time passing."""

import itertools
import logging
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from heapq import heappop, heappush
from queue import Empty, SimpleQueue
from typing import TypeVar

from proxy import clock
from proxy.core.core import Core
from proxy.core.interface.commands import Command
from proxy.core.interface.events import ClockChanged, Event, TimePassed
from proxy.preparing import Preparation
from proxy.tuning import TUNING

log = logging.getLogger(__name__)


T = TypeVar("T")


def _look() -> None:
    """There is an order."""


Item = Event | Callable[[], Event | None]
"""An event, or a job for the loop's thread that may make one."""


_Timed = tuple[float, int, Item]
"""When an item is due, a number that keeps those due at once in order, and the item."""


class Loop:
    """Feeds the core. `execute` carries out each command, on this thread: it must not block.

    While it is synchronised the wall clock is wrong by `clock_error` at most [s]; 0.0: that is not known.
    """

    def __init__(self, core: Core, execute: Callable[[Command], None], clock_error: float = 0.0) -> None:
        self.core = core
        self.faults = 0
        """Events that the core could not digest."""
        self.refused = 0
        """Items that were offered while too many waited."""
        self._execute = execute
        self._take: Callable[[Event], list[Command]] = core.handle
        self._items: SimpleQueue[Item | _Timed | None] = SimpleQueue()
        self._orders: deque[Callable[[], None]] = deque()
        """What is done before all that waits."""
        self._noted: deque[Item] = deque()
        """Events that the core only notes."""
        self._collects = False
        """Whether they are looked for soon."""
        self._core_notes = False
        """Whether there is nothing for which it needs to know of such events at once."""
        self._following: deque[Item] = deque()
        """What follows from what is done now."""
        self._timed: list[_Timed] = []
        self._numbers = itertools.count()
        self._refusing = threading.Lock()
        self._wall = clock.WallWatch(core.view.clocks.offset, clock_error)
        self._preparation = Preparation()
        self._thread = threading.Thread(target=self._run, name="loop", daemon=True)

    def start(self) -> None:
        """Start feeding."""
        self._thread.start()

    def close(self, timeout: float) -> None:
        """Stop after the events that wait already; wait for it at most `timeout` [s]."""
        self._items.put(None)
        self._thread.join(timeout)

    def post(self, item: Item) -> None:
        """Let the core know, whatever waits: of samples, which are bounded elsewhere. From any thread; never blocks.

        What is posted on the loop's own thread, such as that a sample was handed over, follows what is done there now.
        """
        if threading.get_ident() == self._thread.ident:
            self._following.append(item)
        else:
            self._items.put(item)

    def offer(self, item: Item) -> bool:
        """Let the core know, if not too many items wait: for what others cause, and say again. From any thread."""
        if self._items.qsize() >= TUNING.items:
            with self._refusing:
                self.refused += 1
            return False
        self._items.put(item)
        return True

    def order(self, job: Callable[[], None]) -> None:
        """Do what somebody waits for, before all samples that wait. From any thread; never blocks.

        Behind them the status of a daemon with far more samples than it can decide on came seconds late.
        """
        self._orders.append(job)
        self._items.put(_look)

    def note(self, event: Event) -> None:
        """Let the core know, if not too many wait, of what it only notes as things are: with what happens next.

        That is in `TUNING.noted` at the latest: the loop did not wake for each of 200 samples a second that came. From
        any thread.
        """
        if not self._core_notes or len(self._noted) >= TUNING.items:
            self.offer(event)
            return
        self._noted.append(event)
        if not self._collects:
            self._collects = True
            self._items.put((event.now + TUNING.noted, next(self._numbers), self._collect))

    def post_at(self, when: float, item: Item) -> None:
        """Let the core know at `when` [s, our clock] or soon after, in the order of these times."""
        self._items.put(item if when <= clock.monotonic() else (when, next(self._numbers), item))

    def at(self, when: float, item: Item) -> None:
        """Let the core know at `when` [s, our clock] or soon after, before what waits. On the loop's thread only."""
        heappush(self._timed, (when, next(self._numbers), item))

    def ask(self, job: Callable[[], T], timeout: float) -> T:
        """Do `job` on the loop's thread, from any other one, before all samples that wait; return what it returns.

        Raises TimeoutError when that takes longer than `timeout` [s]; it may be done later then.
        """
        answer: Future[T] = Future()

        def answered() -> None:
            answer.set_result(job())

        self.order(answered)
        return answer.result(timeout)

    @property
    def waiting(self) -> int:
        """Items that wait for the core."""
        return self._items.qsize() + len(self._timed) + len(self._following) + len(self._noted)

    def handle(self, event: Event) -> None:
        """Take in `event` and carry out what follows. On the loop's thread only."""
        for command in self._take(event):
            self._execute(command)

    def record(self, take: Callable[[Event], list[Command]] | None) -> None:
        """Have `take` hand events to the core from now on, and see what it does; None: nobody. On the loop's thread."""
        self._take = self.core.handle if take is None else take

    def _run(self) -> None:
        wake_at = clock.monotonic()
        while (item := self._next(wake_at)) is not None:
            wake_at = self._digest(item)

    def _next(self, wake_at: float) -> Item | None:
        while True:
            if self._orders:
                return self._orders.popleft()
            now = clock.monotonic()
            if self._timed and self._timed[0][0] <= now:
                return heappop(self._timed)[2]
            for noted in (self._following, self._noted):
                if noted:
                    return noted.popleft()
            until = min(wake_at, self._timed[0][0]) if self._timed else wake_at
            try:
                item = self._items.get(timeout=max(until - now, 0.0))
            except Empty:
                if until == wake_at:
                    return TimePassed(clock.monotonic())
                continue
            if not isinstance(item, tuple):
                return item
            heappush(self._timed, item)

    def _collect(self) -> None:
        """What was noted comes next; for what is noted from now on it is looked again."""
        self._collects = False

    def _digest(self, item: Item) -> float:
        """Handle one item; return when time must pass next."""
        try:
            event = item() if callable(item) else item
            if event is not None:
                self.handle(event)
            self._preparation.follow(self.core)
            now = clock.monotonic()
            wall = self._wall.look(now)
            if wall is not None:
                self.handle(ClockChanged(now, wall.offset, wall.error))
            self._core_notes = self.core.notes
            return self.core.wake_at(now)
        except Exception:
            self.faults += 1
            log.exception("the core cannot handle %s", type(item).__name__)
            return clock.monotonic() + 0.1
