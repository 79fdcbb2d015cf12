"""Finds out where this Python keeps what its threads do: it is asked, and what it answers is looked for in its memory.

Each version of Python lays out its structures in another way and does not say how. But it says what stands in them:
which frame a thread is in, which code a frame runs, who called it, which thread is the next.
"""

import ctypes
import sys
import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from types import FrameType
from typing import TypeVar

from proxy.errors import ProxyError
from proxy.profiling._native import Layout, words

_STATE, _FRAME, _INNER, _OBJECT = 40, 8, 4, 4
"""In how many words of each structure something is looked for; of the first two `module.cpp` reads as many."""
_TAGS = 7
"""Pointers to code may be marked in these bits."""

T = TypeVar("T")
Place = tuple[int, int]
"""A word of a thread's state, and a word of what that points to; -1: the word itself is meant."""


class LayoutError(ProxyError):
    """This Python keeps what its threads do where it is not found."""


@dataclass(frozen=True, slots=True)
class _Reading:
    """What a thread's state is while it is in a known `frame`, and what that is. `inner` are words of state's words."""

    state: list[int]
    inner: dict[int, list[int]]
    frame: int
    words: list[int]
    """What the frame is."""
    caller: int
    code: int

    def current(self) -> set[Place]:
        """Where the current frame stands."""
        direct = {(at, -1) for at, word in enumerate(self.state) if word == self.frame}
        behind = {(at, to) for at, row in self.inner.items() for to, word in enumerate(row) if word == self.frame}
        return direct or behind


def find_layout() -> Layout:
    """Find it, on a thread that is not the first. Raises LayoutError."""
    states = _states()
    _words(states[-1], _STATE)
    own = _asked("PyThreadState_Get")
    readings = _read(own), _deeper(own)
    known = readings[0]
    current, inner = _first("the current frame", set.intersection(*(each.current() for each in readings)))
    return Layout(
        oldest=states[-1],
        newer=_at("the newer thread", words(states[-1], _STATE), lambda word: word == states[-2]),
        native=_at("a thread's id", known.state, lambda word: word == threading.get_native_id()),
        current=current,
        inner=inner,
        code=_at("the code", known.words, lambda word: word & ~_TAGS == known.code),
        previous=_at("the caller", known.words, lambda word: word == known.caller),
    )


def _states() -> list[int]:
    """Return the states of all threads, the newest first."""
    states, state = [], _asked("PyInterpreterState_ThreadHead", _asked("PyInterpreterState_Get"))
    while state:
        states.append(state)
        state = _asked("PyThreadState_Next", state)
    if len(states) < 2:
        raise LayoutError("one thread alone cannot find out where Python keeps others")
    return states


def _asked(name: str, *arguments: int) -> int:
    """Call a function of Python's that returns a pointer."""
    function = ctypes.PYFUNCTYPE(ctypes.c_void_p, *[ctypes.c_void_p] * len(arguments))((name, ctypes.pythonapi))
    return function(*arguments) or 0


def _read(state: int) -> _Reading:
    """Read the state of this thread while it is in here: what is called meanwhile has no frame of its own.

    A comprehension would have one, in some versions of Python.
    """
    read = words(state, _STATE)
    inner = {}
    for number, word in enumerate(read):
        inner[number] = words(word, _INNER)
    frame = sys._getframe()  # noqa: SLF001 - its documented name
    at = _frame(frame)
    return _Reading(read, inner, at, words(at, _FRAME), _frame(frame.f_back), id(frame.f_code))


def _deeper(state: int) -> _Reading:
    return _read(state)


def _frame(of: FrameType | None) -> int:
    """Return where a frame is, to which its object points, behind its header and the object that called it."""
    return _words(id(of), _OBJECT)[3]


def _words(address: int, count: int) -> list[int]:
    """Read what surely is there. Raises LayoutError where the kernel does not let us."""
    read = words(address, count)
    if not read:
        raise LayoutError("the kernel does not let this process read its own memory (process_vm_readv)")
    return read


def _at(what: str, read: list[int], meant: Callable[[int], bool]) -> int:
    return _first(what, [at for at, word in enumerate(read) if meant(word)])


def _first(what: str, found: Iterable[T]) -> T:
    for each in found:
        return each
    raise LayoutError(f"Python {sys.version.split()[0]} keeps {what} where it is not found")
