"""The one thread on which the core runs: events in, commands out, time passing.

Whoever brings a sample that only has to be sent on does that himself, if nothing else waits for the core: to wake this
thread for it would take longer. Who has extracted features from it sees to it whatever it needs, a search included.
Meanwhile he holds the *lease* of the core, which this thread has whenever it works.
"""

import itertools
import logging
import math
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from enum import Enum, auto
from heapq import heappop, heappush
from queue import Empty, SimpleQueue
from typing import TypeVar

from proxy import clock
from proxy.core.core import Core
from proxy.core.interface.commands import Command
from proxy.core.interface.events import ClockChanged, Event, TimePassed
from proxy.core.interface.taker import Taker
from proxy.preparing import Preparation
from proxy.tuning import TUNING

log = logging.getLogger(__name__)


T = TypeVar("T")


Item = Event | Callable[[], Event | None]
"""An event, or a job for the loop's thread that may make one."""


_Timed = tuple[float, int, Item]
"""When an item is due, a number that keeps those due at once in order, and the item."""


class _Rest(Enum):
    """What the loop's thread does when nothing is to be done."""

    WAIT = auto()
    END = auto()


class Loop:
    """Feeds the core. `execute` carries out each command, for one thread at a time: it must not block.

    While it is synchronised the wall clock is wrong by `clock_error` at most [s]; 0.0: that is not known.
    """

    def __init__(self, core: Core, execute: Callable[[Command], None], clock_error: float = 0.0) -> None:
        self.core = core
        self.faults = 0
        """Events that the core could not digest."""
        self.refused = 0
        """Items that were offered while too many waited."""
        self._execute = execute
        self._taker: Taker = core
        self._lease = threading.Lock()
        """Held by the thread that uses the core, which is the `_user`."""
        self._user = 0
        self._items: deque[Item | _Timed | None] = deque()
        self._bell: SimpleQueue[None] = SimpleQueue()
        self._ended = False
        self._awake = True
        """Whether the loop's thread will look at what waits before it sleeps."""
        self._wake_at = self._until = -math.inf
        """When time must pass next, and until when the loop's thread sleeps [s]."""
        self._orders: deque[Callable[[], None]] = deque()
        """What is done before all that waits."""
        self._noted: deque[Item] = deque()
        """What the core only notes."""
        self._collect_at = -math.inf
        """When it is looked whether there is more of it, as there was some lately [s]: to be woken costs more."""
        self._core_notes = False
        """Whether there is nothing for which it needs to know of such events at once."""
        self._following: deque[Item] = deque()
        """What follows from what is done now."""
        self._timed: list[_Timed] = []
        self._numbers = itertools.count()
        self._refusing = threading.Lock()
        self._wall = clock.WallWatch(core.view.clocks.offset, clock_error)
        self.preparation = Preparation()
        self._thread = threading.Thread(target=self._run, name="loop", daemon=True)

    def start(self) -> None:
        """Start feeding."""
        self._thread.start()

    def close(self, timeout: float) -> None:
        """Stop after the events that wait already; wait for it at most `timeout` [s]."""
        self._put(None)
        self._thread.join(timeout)

    def post(self, item: Item) -> None:
        """Let the core know, whatever waits: of samples, which are bounded elsewhere. From any thread; never blocks.

        What is posted on the loop's own thread, such as that a sample was handed over, follows what is done there now.
        """
        if threading.get_ident() == self._user:
            self._following.append(item)
        else:
            self._put(item)

    def offer(self, item: Item) -> bool:
        """Let the core know, if not too many items wait: for what others cause, and say again. From any thread."""
        if len(self._items) >= TUNING.items:
            with self._refusing:
                self.refused += 1
            return False
        self._put(item)
        return True

    def order(self, job: Callable[[], None]) -> None:
        """Do what somebody waits for, before all samples that wait. From any thread; never blocks.

        Behind them the status of a daemon with far more samples than it can decide on came seconds late.
        """
        self._orders.append(job)
        self._ring()

    def note(self, item: Item) -> None:
        """Let the core know, if not too many wait, of what it only notes as things are: with what happens next.

        That is in `TUNING.noted` at the latest, or when so much has come: the loop did not wake for each of 200 samples
        a second that came. From any thread.
        """
        if not self._core_notes or len(self._noted) >= TUNING.items:
            self.offer(item)
            return
        self._noted.append(item)
        late = self._until > clock.monotonic() + TUNING.noted
        if late or len(self._noted) >= TUNING.noted_at_once or not self._core_notes:
            self._ring()

    def post_at(self, when: float, item: Item) -> None:
        """Let the core know at `when` [s, our clock] or soon after, in the order of these times."""
        self._put(item if when <= clock.monotonic() else (when, next(self._numbers), item))

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
        return len(self._items) + len(self._timed) + len(self._following) + len(self._noted)

    def handle(self, event: Event) -> None:
        """Take in `event` and carry out what follows. On the loop's thread only."""
        for command in self._taker.handle(event):
            self._execute(command)

    def lead(self, event: Event) -> bool:
        """Have the core take in a sample on this thread, if it only has to be sent on; return whether it did.

        Not while anything else waits for the core, or another thread uses it: samples go in the order in which they
        came. From any thread; never blocks.
        """
        if not self._lease.acquire(blocking=False):
            return False
        try:
            if self._ended or self._waits(event.now) or (commands := self._taker.pass_on(event)) is None:
                return False
            self._user = threading.get_ident()
            for command in commands:
                self._execute(command)
            while self._following and self._passes(self._following[0]):
                self._following.popleft()
            self._wake_at = self.core.wake_at(event.now)
        except Exception as error:  # noqa: BLE001 - whatever fails in there
            self._fail(event, error)
        finally:
            self._user = 0
            self._lease.release()
        if self._following or self._wake_at < self._until:
            self._ring()
        return True

    def bring(self, item: Item) -> bool:
        """Do an item on this thread, and what follows from it, if nothing waits for the core; return whether it did.

        What the core only notes comes before it. For who has time: a search may follow. From any thread but the loop's;
        never blocks.
        """
        if not self._lease.acquire(blocking=False):
            return False
        try:
            if self._ended or self._waits(clock.monotonic(), noted=False):
                return False
            self._user = threading.get_ident()
            for noted in [self._noted.popleft() for _ in range(len(self._noted))]:
                self._digest(noted)
            self._following.append(item)
            while self._following and not (self._items or self._orders):
                self._wake_at = self._digest(self._following.popleft())
            due = bool(self._following) or self._due_sooner() or bool(self._noted and not self._core_notes)
        finally:
            self._user = 0
            self._lease.release()
        if due:
            self._ring()
        return True

    def _due_sooner(self) -> bool:
        """Whether something is due before the loop's thread wakes."""
        return self._wake_at < self._until or bool(self._timed and self._timed[0][0] < self._until)

    def _waits(self, now: float, *, noted: bool = True) -> bool:
        """Whether anything is to be done before a sample that came now; `noted`: what the core only notes is, too."""
        if self._items or self._orders or self._following or (noted and self._noted):
            return True
        return bool(self._timed) and self._timed[0][0] <= now

    def _passes(self, item: object) -> bool:
        """Have the core take in what follows, if that asks for nothing else; whether it did."""
        return isinstance(item, Event) and self._taker.pass_on(item) == []

    def record(self, taker: Taker | None) -> None:
        """Have `taker` hand events to the core from now on; None: nobody, they go to it. On the loop's thread only."""
        self._taker = self.core if taker is None else taker

    def _put(self, item: Item | _Timed | None) -> None:
        self._items.append(item)
        self._ring()

    def _ring(self) -> None:
        """Have the loop's thread look what waits; whoever calls has put it there before."""
        if not self._awake:
            self._awake = True
            self._bell.put(None)

    def _run(self) -> None:
        self._wake_at = clock.monotonic()
        while self._work():
            self._awake = False
            if not (self._items or self._orders or self._following or self._noted or self._due_sooner()):
                with suppress(Empty):
                    self._bell.get(timeout=max(self._until - clock.monotonic(), 0.0))
            self._awake = True

    def _work(self) -> bool:
        """Do all that is to be done; return whether there will be more."""
        with self._lease:
            self._user = threading.get_ident()
            while not isinstance(item := self._next(), _Rest):
                self._wake_at = self._digest(item)
            self._user = 0
            self._ended = item is _Rest.END
            return not self._ended

    def _next(self) -> Item | _Rest:
        while True:
            if self._orders:
                return self._orders.popleft()
            now = clock.monotonic()
            if self._timed and self._timed[0][0] <= now:
                return heappop(self._timed)[2]
            waiting = self._following or self._noted or self._items
            if not waiting:
                return self._rest(now)
            if waiting is self._noted:
                self._collect_at = now + TUNING.noted
            item = waiting.popleft()
            if not isinstance(item, tuple):
                return _Rest.END if item is None else item
            heappush(self._timed, item)

    def _rest(self, now: float) -> Item | _Rest:
        """Time passes, or nothing is to be done until it does."""
        if self._wake_at <= now:
            return TimePassed(now)
        self._until = min(self._wake_at, self._timed[0][0]) if self._timed else self._wake_at
        if self._collect_at > now:
            self._until = min(self._until, self._collect_at)
        return _Rest.WAIT

    def _digest(self, item: Item) -> float:
        """Handle one item; return when time must pass next."""
        try:
            event = item() if callable(item) else item
            if event is not None:
                self.handle(event)
            self.preparation.follow(self.core)
            now = clock.monotonic()
            wall = self._wall.look(now)
            if wall is not None:
                self.handle(ClockChanged(now, wall.offset, wall.error))
            self._core_notes = self.core.notes
            return self.core.wake_at(now)
        except Exception as error:  # noqa: BLE001 - whatever fails in there
            self._fail(item, error)
            return clock.monotonic() + 0.1

    def _fail(self, item: Item, error: Exception) -> None:
        self.faults += 1
        log.error("the core cannot handle %s", type(item).__name__, exc_info=error)
