"""What waits for the core, and in which order it is taken. Any thread may add to it; one at a time takes from it."""

import itertools
import math
from collections import deque
from collections.abc import Callable
from enum import Enum, auto
from heapq import heappop, heappush

from proxy.core.interface.events import Event
from proxy.tuning import TUNING

Item = Event | Callable[[], Event | None]
"""An event, or a job for the loop's thread that may make one."""
_Timed = tuple[float, int, Item]
"""When an item is due, a number that keeps those due at once in order, and the item."""


class Nothing(Enum):
    """Why there is no item to take."""

    YET = auto()
    EVER = auto()
    """All was taken that came before the end."""


class Agenda:
    """Orders first; then what is due, what follows from what was done last, what the core only notes, and all else.

    Of all else some goes between what follows, and what is noted before that: when room opens for a hundred samples
    that wait, one decision follows another for 50 ms. A sample that came meanwhile was taken up after the last one,
    however urgent it was.
    """

    def __init__(self) -> None:
        self.orders: deque[Callable[[], None]] = deque()
        """What is done before all that waits."""
        self.following: deque[Item] = deque()
        """What follows from what is done now."""
        self.noted: deque[Item] = deque()
        """What the core only notes."""
        self._items: deque[Item | _Timed | None] = deque()
        self._timed: list[_Timed] = []
        self._numbers = itertools.count()
        self._between = 0
        """How much of all else was taken since something that follows was."""
        self._collect_at = -math.inf
        """When it is looked whether more was noted, as something was lately [s]: to be woken costs more."""

    def __len__(self) -> int:
        return len(self._items) + len(self._timed) + len(self.following) + len(self.noted)

    @property
    def full(self) -> bool:
        """Whether so much waits that what others cause is refused."""
        return len(self._items) >= TUNING.items

    def put(self, item: Item | None) -> None:
        """Take an item after all that waits; None: it is the last."""
        self._items.append(item)

    def put_at(self, when: float, item: Item) -> None:
        """Take it at that time [s], once all that waits now was taken: from any thread."""
        self._items.append((when, next(self._numbers), item))

    def at(self, when: float, item: Item) -> None:
        """Take it at that time [s]. Only for the thread that takes items."""
        heappush(self._timed, (when, next(self._numbers), item))

    def take(self, now: float) -> Item | Nothing:
        """Return what is done next, if anything is to be done now."""
        while True:
            if self.orders:
                return self.orders.popleft()
            if self._timed and self._timed[0][0] <= now:
                return heappop(self._timed)[2]
            waiting = self._first()
            if not waiting:
                return Nothing.YET
            if waiting is self.noted:
                self._collect_at = now + TUNING.noted
            item = waiting.popleft()
            if not isinstance(item, tuple):
                return Nothing.EVER if item is None else item
            heappush(self._timed, item)

    def _first(self) -> deque[Item] | deque[Item | _Timed | None]:
        """Return where the next item is taken from; it is empty where nothing waits."""
        if not self.following:
            return self.noted or self._items
        if self._items and self._items[0] is not None and self._between < TUNING.between:
            if self.noted:  # it came before: a later digest of its robot may be among the items
                return self.noted
            self._between += 1
            return self._items
        self._between = 0
        return self.following

    def waits(self, now: float, *, noted: bool = True) -> bool:
        """Whether anything is to be done before a sample that came now; `noted`: what the core only notes is, too."""
        if self._items or self.orders or self.following or (noted and self.noted):
            return True
        return self.due() <= now

    @property
    def urgent(self) -> bool:
        """Whether anything waits that does not wait for its time: orders, or what came from elsewhere."""
        return bool(self._items or self.orders)

    def due(self) -> float:
        """Return when the first of what waits for its time is due [s]; ∞ where nothing does."""
        return self._timed[0][0] if self._timed else math.inf

    def sleeps_until(self, now: float) -> float:
        """Return when it has to be looked at again where nothing is to be done now [s]; else ∞."""
        return min(self.due(), self._collect_at) if self._collect_at > now else self.due()
