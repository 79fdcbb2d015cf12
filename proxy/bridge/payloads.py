"""The samples that the core knows by number: the one home of their payloads."""

import itertools
from collections.abc import Callable
from typing import NamedTuple

from proxy.bridge.room import Room
from proxy.bridge.sample import Held
from proxy.bridge.tuning import TUNING


class Content(NamedTuple):
    """A payload of so many bytes; `read` gives it out with its encoding."""

    size: int
    read: Callable[[], tuple[bytes, str]]


class Payloads:
    """Samples that wait for their decision, which have a place in the `room`, and samples that are kept for copies.

    One may be both. What waits is bounded by the room, what is kept by the core. From any thread.
    """

    def __init__(self, room: Room) -> None:
        self._room = room
        self._numbers = itertools.count(1)
        self._waiting: dict[int, Held] = {}
        self._kept: dict[int, Held] = {}

    def __len__(self) -> int:
        """Return how many samples wait for their decision."""
        return len(self._waiting)

    def enter(self, held: Held) -> int | None:
        """Let a sample wait; return its number, or None when there is no room."""
        if not self._room.enter(held.size):
            return None
        number = next(self._numbers)
        self._waiting[number] = held.apart if self._room.samples > TUNING.few_held or held.shared else held
        return number

    def holds(self, key: str) -> bool:
        """Whether a sample of a key waits."""
        return bool(self._waiting) and any(held.key == key for held in list(self._waiting.values()))

    def waiting(self, number: int) -> Held | None:
        """Return a sample that waits; None when it does not (any more)."""
        return self._waiting.get(number)

    def content(self, number: int) -> Content | None:
        """Return the payload of a sample that waits, which can be read later, too."""
        held = self.waiting(number)
        if held is None:
            return None
        sample = held.apart.sample
        return Content(held.size, lambda: (sample.payload.to_bytes(), str(sample.encoding)))

    def release(self, number: int) -> Held | None:
        """Give out a sample that waits, which keeps its place in the room; None when it does not wait (any more)."""
        return self._waiting.pop(number, None)

    def drop(self, number: int) -> None:
        """Let a sample wait no longer, if it does."""
        if (held := self.release(number)) is not None:
            self._room.leave(held.size)

    def keep(self, number: int) -> None:
        """Keep a sample that waits, whatever becomes of it, until `forget`."""
        if (held := self.waiting(number)) is not None:
            self._kept[number] = held.apart

    def forget(self, number: int) -> None:
        """Keep a sample no longer."""
        self._kept.pop(number, None)

    def copy(self, number: int, to: str) -> Held | None:
        """Return a sample that is kept, addressed to the robot with the tag `to` alone; None when it is not kept."""
        held = self._kept.get(number)
        return None if held is None else held._replace(to=to)
