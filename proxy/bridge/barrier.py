"""Keeps samples from overtaking what was declared before them.

Samples cross at once; what is declared crosses when it has been mirrored, some milliseconds later. Who declares a
subscriber, asks for a sample by another one, and gets it from the robot that hears that, would miss it; who hears that
a service is there, and asks it, would find nobody. So a sample of a key that was quiet waits until all that was
declared before it is mirrored. What comes behind it waits, too, or it would overtake that sample. Streams do not stop
for it: nobody begins to listen because of one more sample of a stream.
"""

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

Job = Callable[[], object]


class _Held(NamedTuple):
    key: str
    size: int
    after: int
    """The round after which it goes."""
    job: Job


class Barrier:
    """One direction: what nodes of `near` declare, and publish, for those of `far`.

    What is declared is mirrored in rounds. A round tells of all that was declared before it began: it is over when the
    mirror session of `near` was told of that, `fence` says that it is mirrored, and the main session of `far` knows.
    What was held goes by `executor`, for it may have to wait for who takes it.
    """

    def __init__(self, near: Declarations, far: Declarations, fence: Fence, executor: SerialExecutor) -> None:
        self._near, self._far, self._fence, self._executor = near, far, fence, executor
        self._lock = threading.Lock()
        self._came: dict[str, float] = {}
        """When the last sample of each key came [s]."""
        self._held: deque[_Held] = deque()
        self._keys = Counter[str]()
        """Of which keys samples are held or about to go, how many..."""
        self._count = self._bytes = 0
        """... and how many and how much they are together."""
        self._begun = self._over = 0
        """The numbers of the last round that began, and of the last one that is over."""
        self._until = math.inf
        """When the round that has begun is given up [s]."""
        self._rest, self._rests_until = TUNING.barrier_rest, -math.inf
        """How long no sample is held after the next round that is given up, and until when none is now [s]."""
        self._going_since = math.inf
        """Since when the sample that goes now does [s]: who takes it may hang."""

    def holds(self, key: str, now: float, *, ordered: bool) -> bool | None:
        """Whether a sample that came now is held for a round of its own; None: it is not held.

        An `ordered` one goes behind whatever is held, others behind those of their key. Called for every sample.
        """
        came = self._came.get(key, -math.inf)
        self._came[key] = now
        quiet = now >= came + TUNING.quiet_key
        if not (quiet or self._keys) or now > self._going_since + TUNING.barrier_wait:
            return None
        if len(self._came) > BOUNDS.keys:
            self._came.clear()
        if key in self._keys:
            return False
        if self._count >= BOUNDS.held_samples or self._bytes >= BOUNDS.held_bytes:
            return None
        if quiet and now >= self._rests_until:
            return True
        return False if ordered and self._keys else None

    def hold(self, key: str, now: float, size: int, job: Job, *, quiet: bool) -> None:
        """Do `job` after all that is held, and if its key was `quiet` after all that is declared by now is mirrored."""
        with self._lock:
            before = self._held[-1].after if self._held else self._over
            self._held.append(_Held(key, size, self._begun + 1 if quiet else before, job))
            self._keys[key] += 1
            self._count, self._bytes = self._count + 1, self._bytes + size
            begins = self._release(now)
        if begins:
            self._near.after_told(partial(self._told, begins))
        self.check(now)

    def check(self, now: float) -> float | None:
        """Give up a round that takes too long; return when to look again [s], if it matters."""
        with self._lock:
            if now >= self._until:
                self._rests_until = now + self._rest
                self._rest = min(2.0 * self._rest, TUNING.longest_barrier_rest)
                self._begun += 1  # so that it is another one that is over
                self._end(self._begun, now)
        return None if self._until == math.inf else self._until

    def close(self) -> None:
        """Hold nothing more, and do what is held."""
        with self._lock:
            self._rests_until = math.inf
            held, self._held = self._held, deque()
        for each in held:
            self._do(each)

    def _told(self, number: int) -> None:
        self._fence.then(partial(self._mirrored, number))

    def _mirrored(self, number: int) -> None:
        self._far.after_taken(partial(self._taken, number))

    def _taken(self, number: int) -> None:
        now = clock.monotonic()
        with self._lock:
            self._rest = TUNING.barrier_rest
            begins = self._end(number, now)
        if begins:
            self._near.after_told(partial(self._told, begins))

    def _end(self, number: int, now: float) -> int:
        """Say that a round is over, unless it was given up; return the number of the next one if it begins."""
        if number != self._begun:
            return 0
        self._over, self._until = number, math.inf
        return self._release(now)

    def _release(self, now: float) -> int:
        """Let go what waits for no round; return the number of the next round if it begins."""
        while self._held and self._held[0].after <= self._over:
            self._executor.insist(partial(self._do, self._held.popleft()))
        if not self._held or self._begun > self._over:
            return 0
        self._begun += 1
        self._until = now + TUNING.barrier_wait
        return self._begun

    def _do(self, held: _Held) -> None:
        self._going_since = clock.monotonic()
        try:
            held.job()
        finally:
            self._going_since = math.inf
            with self._lock:
                self._keys[held.key] -= 1
                if not self._keys[held.key]:
                    del self._keys[held.key]
                self._count, self._bytes = self._count - 1, self._bytes - held.size
