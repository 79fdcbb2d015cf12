"""The one thread on which the core runs: events in, commands out, time passing.

Whoever brings a sample that only has to be sent on does that himself, if nothing else waits for the core: to wake this
thread for it would take longer. Who has extracted features from it sees to it whatever it needs, a search included.
Meanwhile he holds the *lease* of the core, which this thread has whenever it works.
"""

import math
import threading
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from queue import Empty, SimpleQueue
from typing import TypeVar

from proxy import clock
from proxy.agenda import Agenda, Item, Nothing
from proxy.core.core import Core
from proxy.core.interface.commands import Command
from proxy.core.interface.events import Event, TimePassed
from proxy.feed import Feed
from proxy.tuning import TUNING

T = TypeVar("T")


class Loop:
    """Feeds the core. `execute` and `clock_error` are as in `Feed`."""

    def __init__(self, core: Core, execute: Callable[[Command], None], clock_error: float = 0.0) -> None:
        self.core = core
        self.feed = Feed(core, execute, clock_error)
        """Only for the thread that uses the core."""
        self.refused = 0
        """Items that were offered while too many waited."""
        self._lease = threading.Lock()
        """Held by the thread that uses the core, which is the `_user`."""
        self._user = 0
        self._agenda = Agenda()
        self._bell: SimpleQueue[None] = SimpleQueue()
        self._ended = False
        self._awake = True
        """Whether the loop's thread will look at what waits before it sleeps."""
        self._wake_at = self._until = -math.inf
        """When time must pass next, and until when the loop's thread sleeps [s]."""
        self._refusing = threading.Lock()
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
            self._agenda.following.append(item)
        else:
            self._put(item)

    def offer(self, item: Item) -> bool:
        """Let the core know, if not too many items wait: for what others cause, and say again. From any thread."""
        if self._agenda.full:
            with self._refusing:
                self.refused += 1
            return False
        self._put(item)
        return True

    def order(self, job: Callable[[], None]) -> None:
        """Do what somebody waits for, before all samples that wait. From any thread; never blocks.

        Behind them the status of a daemon with far more samples than it can decide on came seconds late.
        """
        self._agenda.orders.append(job)
        self._ring()

    def note(self, item: Item) -> None:
        """Let the core know, if not too many wait, of what it only notes as things are: with what happens next.

        That is in `TUNING.noted` at the latest, or when so much has come: the loop did not wake for each of 200 samples
        a second that came. From any thread.
        """
        noted = self._agenda.noted
        # Where anything else waits this waits behind it: an earlier digest of its robot may be there.
        if not self.feed.notes or self._agenda.urgent or len(noted) >= TUNING.items:
            self.offer(item)
            return
        noted.append(item)
        late = self._until > clock.monotonic() + TUNING.noted
        if late or len(noted) >= TUNING.noted_at_once or not self.feed.notes:
            self._ring()

    def post_at(self, when: float, item: Item) -> None:
        """Let the core know at `when` [s, our clock] or soon after, in the order of these times."""
        if when <= clock.monotonic():
            self._agenda.put(item)
        else:
            self._agenda.put_at(when, item)
        self._ring()

    def at(self, when: float, item: Item) -> None:
        """Let the core know at `when` [s, our clock] or soon after, before what waits. On the loop's thread only."""
        self._agenda.at(when, item)

    def ask(self, job: Callable[[], T], timeout: float) -> T:
        """Do `job` on the loop's thread, from any other one, before all samples that wait; return what it returns.

        Raises what the job does, and TimeoutError when it takes longer than `timeout` [s]; it may be done later then.
        """
        answer: Future[T] = Future()

        def answered() -> None:
            try:
                answer.set_result(job())
            except (Exception, SystemExit) as error:
                answer.set_exception(error)
                raise

        self.order(answered)
        return answer.result(timeout)

    @property
    def waiting(self) -> int:
        """Items that wait for the core."""
        return len(self._agenda)

    def lead(self, event: Event) -> bool:
        """Have the core take in a sample on this thread, if it only has to be sent on; return whether it did.

        Not while anything else waits for the core, or another thread uses it: samples go in the order in which they
        came. From any thread; never blocks.
        """
        agenda = self._agenda
        if not self._lease.acquire(blocking=False):
            return False
        try:
            if self._ended or agenda.waits(event.now):
                return False
            self._user = threading.get_ident()
            if not self.feed.pass_on(event):
                return False
            while agenda.following and self.feed.passes(agenda.following[0]):
                agenda.following.popleft()
            self._wake_at = self.core.wake_at(event.now)
        except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever fails in there
            self.feed.fail(event, error)
        finally:
            self._user = 0
            self._lease.release()
        if agenda.following or self._wake_at < self._until:
            self._ring()
        return True

    def bring(self, item: Item) -> bool:
        """Do an item on this thread, and what follows from it, if nothing waits for the core; return whether it did.

        What the core only notes comes before it. For who has time: a search may follow. From any thread but the loop's;
        never blocks.
        """
        agenda = self._agenda
        if not self._lease.acquire(blocking=False):
            return False
        try:
            if self._ended or agenda.waits(clock.monotonic(), noted=False):
                return False
            self._user = threading.get_ident()
            for noted in [agenda.noted.popleft() for _ in range(len(agenda.noted))]:
                self.feed.digest(noted)
            agenda.following.append(item)
            while agenda.following and not agenda.urgent:
                self._wake_at = self.feed.digest(agenda.following.popleft())
            due = bool(agenda.following) or self._due_sooner() or bool(agenda.noted and not self.feed.notes)
        finally:
            self._user = 0
            self._lease.release()
        if due:
            self._ring()
        return True

    def _due_sooner(self) -> bool:
        """Whether something is due before the loop's thread wakes."""
        return min(self._wake_at, self._agenda.due()) < self._until

    def _put(self, item: Item | None) -> None:
        self._agenda.put(item)
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
            if not (self._agenda.waits(-math.inf) or self._due_sooner()):
                with suppress(Empty):
                    self._bell.get(timeout=max(self._until - clock.monotonic(), 0.0))
            self._awake = True

    def _work(self) -> bool:
        """Do all that is to be done; return whether there will be more."""
        with self._lease:
            self._user = threading.get_ident()
            while not isinstance(item := self._next(), Nothing):
                self._wake_at = self.feed.digest(item)
            self._user = 0
            self._ended = item is Nothing.EVER
            return not self._ended

    def _next(self) -> Item | Nothing:
        """Return what is to be done now: also that time passes, if nothing else is."""
        now = clock.monotonic()
        item = self._agenda.take(now)
        if item is not Nothing.YET:
            return item
        if self._wake_at <= now:
            return TimePassed(now)
        self._until = min(self._wake_at, self._agenda.sleeps_until(now))
        return item
