"""Samples where this process spends its processor time: by thread and by what each was in.

Python cannot look at its threads at any moment: it needs its lock for that, and gets it where a thread is about to
wait. So all of them would be found waiting: of a thread whose turns take 0.1 ms none was ever seen inside of one. Here
each thread looks at itself, in C++, whenever it has run for a while (`native/module.cpp`). In the end what each took,
as the kernel counts it, is shared out among what it was seen to run.
"""

import sys
import threading
import time
import traceback
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from types import FrameType

from proxy import clock
from proxy.profiling import threads as kernel
from proxy.profiling._native import Layout
from proxy.profiling._native import Sampler as Eyes
from proxy.profiling.functions import Function, Functions

TURN = 0.25
"""Time between two looks for threads and functions that came [s]."""
DEEP = 60
"""So many functions may be a part of a stack: `module.cpp` reads the 64 innermost."""

Stack = tuple[Function, ...]
"""The functions that a thread is in, the innermost first; none outside of Python."""


@dataclass(frozen=True, slots=True)
class Spent:
    """What a thread of this name took of the processor in one stack [s]."""

    thread: str
    stack: Stack
    seconds: float


class Sampler:
    """Samples for `seconds`, on the thread that runs it; each thread looks `rate` times in a second that it runs."""

    def __init__(self, layout: Layout, seconds: float, rate: float) -> None:
        self._layout = layout
        self._seconds = seconds
        self._rate = rate
        self._stopped = False
        self._names: dict[int, str] = {}
        self._functions = Functions()
        self.looks = 0
        self.seconds = 0.0
        """How long it sampled [s]..."""
        self.whole = 0.0
        """... what all threads together took of the processor meanwhile, but for..."""
        self.own = 0.0
        """... what sampling took [s]."""

    def stop(self) -> None:
        """End within a `TURN`; from any thread."""
        self._stopped = True

    def run(self) -> list[Spent]:
        """Sample until it is time, or until stopped."""
        self._eyes = eyes = Eyes(self._layout, 1.0 / self._rate)
        try:
            return self._sample(eyes)
        finally:
            eyes.stop()

    def _sample(self, eyes: Eyes) -> list[Spent]:
        began, whole, own = clock.monotonic(), time.process_time(), time.thread_time()
        self._watch(fresh=False)
        end = began + self._seconds
        while not self._stopped and (now := clock.monotonic()) < end:
            time.sleep(min(TURN, end - now))
            self._watch(fresh=True)
        eyes.stop()
        own = time.thread_time() - own
        self.seconds, self.whole = clock.monotonic() - began, time.process_time() - whole - own
        self._name()
        self.looks, self.own = eyes.looks, own + eyes.cost
        return list(self._spent())

    def _watch(self, *, fresh: bool) -> None:
        """Look at threads that came, too, and learn what functions are called while they are there."""
        natives = kernel.others()
        self._eyes.watch(natives, fresh)
        self._names |= kernel.names([native for native in natives if native not in self._names])
        self._name()

    def _name(self) -> None:
        for address in self._eyes.gather():
            self._functions.of(address)

    def _spent(self) -> Iterator[Spent]:
        """Share out what each thread took as it was seen; what took next to nothing was not, and is where it waits."""
        waiting = _waiting()
        counts: dict[int, Counter[Stack]] = defaultdict(Counter)
        for native, addresses, count in self._eyes.seen():
            functions = [self._functions.of(address) for address in addresses]
            counts[native][tuple(each for each in functions if each is not None)] += count
        for native, seconds in self._eyes.taken():
            name = self._names.get(native, "")
            seen = counts[native] if kernel.is_zenohs(name) else _whole(counts[native])
            seen = seen or Counter({waiting.get(native, ()): 1})
            for stack, count in seen.items():
                yield Spent(name, stack, seconds * count / seen.total())


def _waiting() -> dict[int, Stack]:
    """Return where each thread of Python is now, by its native id."""
    natives = {thread.ident: thread.native_id or 0 for thread in threading.enumerate()}
    frames = sys._current_frames()  # noqa: SLF001 - its documented name
    return {natives[ident]: _stack(frame) for ident, frame in frames.items() if ident in natives}


def _stack(frame: FrameType) -> Stack:
    codes = [each.f_code for each, _ in traceback.walk_stack(frame)]
    return tuple(Function(code.co_filename, code.co_qualname) for code in codes)


def _whole(seen: Counter[Stack]) -> Counter[Stack]:
    """Leave out stacks of a Python thread that were read while they changed: all whole ones end in one function."""
    ends = Counter[Stack]()
    for stack, count in seen.items():
        ends[stack[-1:]] += count if stack else 0
    end = max(ends, key=lambda each: ends[each], default=())
    return Counter({stack: count for stack, count in seen.items() if stack[-1:] == end or len(stack) >= DEEP})
