"""Keeps samples from overtaking what was declared before them.

Samples cross at once; what is declared crosses when it has been mirrored, some milliseconds later. Who declares a
subscriber, asks for a sample by another one, and gets it from the robot that hears that, would miss it; who hears that
a service is there, and asks it, would find nobody. So a sample of a key that was quiet waits until all that was
declared before it is mirrored. What comes behind it waits, too, or it would overtake that sample. Streams do not stop
for it: nobody begins to listen because of one more sample of a stream. Queries and replies wait for it as well: who
stores something and asks for it, or answers that it is done, is heard in that order.
"""

import itertools
import logging
import math
import threading
from collections import Counter, deque
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from proxy import clock
from proxy.bridge.bounds import BOUNDS
from proxy.bridge.declarations.declarations import Declarations
from proxy.bridge.fence import Fence
from proxy.bridge.serial_executor import SerialExecutor
from proxy.bridge.tuning import TUNING

log = logging.getLogger(__name__)

Job = Callable[[], object]


class _Held(NamedTuple):
    number: int
    key: str
    size: int
    after: int
    """The round after which it goes."""
    job: Job


class Barrier:
    """One direction: what nodes of `near` declare, and publish, for those of `far`.

    What is declared is mirrored in rounds. A round tells of all that was declared before it began: it is over when the
    mirror session of `near` was told of that, `fence` says that it is mirrored, and the main session of `far` knows.
    What is held goes by `executor`, which waits for the rounds: who mirrors may be busy for longer than a sample waits.
    """

    def __init__(self, near: Declarations, far: Declarations, fence: Fence, executor: SerialExecutor) -> None:
        self._near, self._far, self._fence, self._executor = near, far, fence, executor
        self._turn = threading.Condition(threading.Lock())
        self._came: dict[str, float] = {}
        """When the last sample of each key came [s]."""
        self._forgotten = -math.inf
        """When it was forgotten of all keys: none of them was quiet before that [s]."""
        self._held: deque[_Held] = deque()
        self._keys = Counter[str]()
        """Of which keys samples are held or go, how many..."""
        self._bytes = 0
        """... and how much they are together."""
        self._numbers = itertools.count(1)
        self._left: dict[int, None] = {}
        """The numbers of those that did not go yet, from the oldest on."""
        self._begun = self._over = 0
        """The numbers of the last round that began, and of the last one that is over."""
        self._until = math.inf
        """When the round that began last is given up [s]."""
        self._rest, self._rests_until = TUNING.barrier_rest, -math.inf
        """How long no sample is held after the next round that is given up, and until when none is now [s]."""
        self._going_since = math.inf
        """Since when the sample that goes now does [s]: who takes it may hang."""

    def holds(self, key: str, now: float, *, ordered: bool) -> bool | None:
        """Whether a sample that came now is held for a round of its own; None: it is not held.

        An `ordered` one goes behind whatever is held, others behind those of their key. Called for every sample. Where
        there is no room, or who takes one hangs, nothing more is held: whoever brings a sample does what is held of its
        key first, and is held up by that as without a barrier.
        """
        if len(self._came) > BOUNDS.keys:
            self._came.clear()
            self._forgotten = now
        came = self._came.get(key, self._forgotten)
        self._came[key] = now
        quiet = now >= came + TUNING.quiet_key
        if not (quiet or self._keys):
            return None
        full = len(self._left) >= BOUNDS.held_samples or self._bytes >= BOUNDS.held_bytes
        if full or self._hangs(now):
            if key in self._keys:
                self._do_all(key)
            return None
        if key in self._keys:
            return False
        if quiet and now >= self._rests_until:
            return True
        return False if ordered and self._keys else None

    def hold(self, key: str, now: float, size: int, job: Job, *, quiet: bool) -> None:
        """Do `job` after all that is held, and if its key was `quiet` after all that is declared by now is mirrored."""
        with self._turn:
            before = self._held[-1].after if self._held else self._over
            number = next(self._numbers)
            self._held.append(_Held(number, key, size, self._begun + 1 if quiet else before, job))
            self._left[number] = None
            self._keys[key] += 1
            self._bytes += size
            begins = self._next_round(now)
        self._executor.insist(self._do_first)
        self._begin(begins)

    @property
    def newest(self) -> int:
        """The number of the sample that came last of all that are held, for `await_gone`; 0: none is."""
        with self._turn:
            return next(reversed(self._left), 0)

    def await_gone(self, number: int) -> None:
        """Wait until the sample of this number went, and all before it, but no longer than one waits for its round.

        Where who takes one hangs nobody waits.
        """
        if not number:
            return
        until = clock.monotonic() + TUNING.barrier_wait
        with self._turn:
            while next(iter(self._left), math.inf) <= number and (now := clock.monotonic()) < until:
                if self._hangs(now):
                    return
                self._turn.wait(until - now)

    def close(self, timeout: float) -> None:
        """Hold nothing more, and let go what is held: return when it went, at most after so long [s]."""
        with self._turn:
            self._rests_until = math.inf
            self._give_up()
            self._turn.wait_for(lambda: not self._keys, timeout)

    def _hangs(self, now: float) -> bool:
        """Whether who takes the sample that goes now hangs."""
        return now > self._going_since + TUNING.barrier_wait

    def _begin(self, number: int) -> None:
        if number:
            self._near.after_told(partial(self._told, number))

    def _told(self, number: int) -> None:
        self._fence.then(partial(self._mirrored, number))

    def _mirrored(self, number: int) -> None:
        self._far.after_taken(partial(self._taken, number))

    def _taken(self, number: int) -> None:
        with self._turn:
            self._rest = TUNING.barrier_rest
            if number != self._begun:
                return  # it was given up
            self._over = number
            begins = self._next_round(clock.monotonic())
            self._turn.notify_all()
        self._begin(begins)

    def _next_round(self, now: float) -> int:
        """Return the number of the next round if it is to begin now."""
        if self._begun > self._over or not self._held or self._held[-1].after <= self._over:
            return 0
        self._begun += 1
        self._until = now + TUNING.barrier_wait
        return self._begun

    def _give_up(self) -> None:
        """Wait for no round any more."""
        self._begun = self._over = self._begun + 1  # so that the one under way is another one
        self._turn.notify_all()

    def _do_first(self) -> None:
        """Do what is held for longest as soon as its round is over, or has taken too long."""
        with self._turn:
            while self._held and self._held[0].after > self._over:
                if (now := clock.monotonic()) < self._until:
                    self._turn.wait(self._until - now)
                else:
                    self._rests_until = max(self._rests_until, now + self._rest)
                    self._rest = min(2.0 * self._rest, TUNING.longest_barrier_rest)
                    self._give_up()
            if not self._held:
                return  # others did it
            held = self._held.popleft()
        self._going_since = clock.monotonic()
        self._do(held)
        self._going_since = math.inf

    def _do_all(self, key: str) -> None:
        """Do what is held of a key, and let others end before what they do of it, unless that takes too long."""
        with self._turn:
            found = [held for held in self._held if held.key == key]
            self._held = deque(held for held in self._held if held.key != key)
            self._turn.wait_for(lambda: self._keys[key] <= len(found), TUNING.barrier_wait)
        for held in found:
            self._do(held)

    def _do(self, held: _Held) -> None:
        try:
            held.job()
        except Exception:  # those behind it go all the same
            log.exception("a sample on %s that was held is lost", held.key)
        with self._turn:
            self._keys[held.key] -= 1
            if not self._keys[held.key]:
                del self._keys[held.key]
            del self._left[held.number]
            self._bytes -= held.size
            self._turn.notify_all()
