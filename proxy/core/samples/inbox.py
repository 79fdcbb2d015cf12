"""The samples that wait for a decision, bounded. Of a Markovian stream only the latest does."""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from heapq import heappop, heappush

from proxy.core.model.waiting import Waiting

SUPERSEDED = "dropped:superseded"
OVERFLOW = "dropped:overflow"


@dataclass(frozen=True, slots=True)
class Evicted:
    """A sample that had to leave the inbox, its key, and why."""

    sample: int
    reason: str
    key: str


Place = tuple[int, float, int]
"""Priority, generation time and number of a sample: the least is given out first."""


class Inbox:
    """Gives out the highest priority first, then the oldest.

    At most `capacity` samples of `most_bytes` wait, one counting as half of these at most, and `backlog` of a stream.
    """

    def __init__(self, capacity: int, backlog: int, most_bytes: float = math.inf) -> None:
        self._capacity = capacity
        self._backlog = backlog
        self._most_bytes = most_bytes
        self._bytes = 0.0
        self._waiting: dict[int, Waiting] = {}
        self._keys: dict[str, dict[int, Waiting]] = {}
        self._order: list[Place] = []
        """The places of all that may be taken, as a heap; and of no more that left."""
        self._cheapest: list[tuple[float, float, int]] = []
        """Worth per byte, time and number of all that wait, as a heap; and of no more that left."""
        self._resting: dict[int, float] = {}
        """Until when the others rest [s], by number."""
        self._wakes: list[tuple[float, int]] = []
        """The same as a heap; and some that left."""

    def __len__(self) -> int:
        return len(self._waiting)

    def __contains__(self, sample: int) -> bool:
        return sample in self._waiting

    def __iter__(self) -> Iterator[Waiting]:
        return iter(self._waiting.values())

    @property
    def wakes_at(self) -> float:
        """When the first that rests can be taken again [s]; ∞ where none rests."""
        wakes = self._wakes
        while wakes and self._resting.get(wakes[0][1]) != wakes[0][0]:
            heappop(wakes)
        return wakes[0][0] if wakes else math.inf

    def of(self, key: str) -> list[Waiting]:
        """Return all that waits of a key."""
        return list(self._keys.get(key, {}).values())

    def put(self, new: Waiting) -> list[Evicted]:
        """Queue a sample; return those that had to leave for it (the new one may be among them)."""
        gone = [self._evict(w, SUPERSEDED) for w in self.of(new.key) if new.markovian]
        self._add(new)
        while (least := self._least(new.key)) is not None:
            gone.append(self._evict(least, OVERFLOW))
        return gone

    def full(self, new: Waiting) -> bool:
        """Whether one would have to leave for `new` because too many wait."""
        same = 0 if new.markovian else len(self.of(new.key))
        size = self._bytes + min(new.size, self._most_bytes / 2)
        return same >= self._backlog or len(self) >= self._capacity or size > self._most_bytes

    def supersede(self, key: str) -> list[Evicted]:
        """Remove what waits of a Markovian stream, because something newer came; return it."""
        return [self._evict(w, SUPERSEDED) for w in self.of(key) if w.markovian]

    def clear(self) -> list[Waiting]:
        """Remove and return all that waits."""
        taken = list(self)
        for waiting in taken:
            self._remove(waiting)
        return taken

    def put_back(self, taken: Iterable[Waiting]) -> None:
        """Queue what was taken out before; nothing leaves for it."""
        for waiting in taken:
            self._add(waiting)

    def rest(self, waiting: Waiting, until: float) -> None:
        """Do not give a sample out before this time [s]: to look at all of 256 took three quarters of the time."""
        self._resting[waiting.sample] = until
        heappush(self._wakes, (until, waiting.sample))

    def rests_until(self, sample: int) -> float | None:
        """Return when a sample that rests can be taken again [s]; None where it does not rest."""
        return self._resting.get(sample)

    def wake(self, now: float) -> None:
        """Give out again what rested until now; all, with ∞."""
        while self.wakes_at <= now and self._wakes:
            self.wake_one(heappop(self._wakes)[1])

    def wake_one(self, sample: int) -> None:
        """Give a sample out again that rests."""
        del self._resting[sample]
        heappush(self._order, place(self._waiting[sample]))

    def take(self, held: Callable[[Waiting], bool] = lambda _: False) -> Waiting | None:
        """Remove and return the next sample to decide; one that is `held` back waits, and may `rest` from now on."""
        passed_over, found = [], None
        while found is None and self._order:
            at = heappop(self._order)
            waiting = self._waiting.get(at[-1])
            if waiting is None or at[-1] in self._resting:
                continue
            passed_over.append(at)
            found = None if held(waiting) else waiting
        if found is not None:
            passed_over.pop()
            self._remove(found)
        for at in passed_over:
            if at[-1] not in self._resting:
                heappush(self._order, at)
        return found

    def _least(self, key: str) -> Waiting | None:
        """Return what has to leave: the least valuable of a key with too many, else the least per byte of all."""
        same = self.of(key)
        if len(same) > self._backlog:
            return min(same, key=lambda w: (w.scale, w.t_gen, w.sample))
        if len(self) > self._capacity or self._bytes > self._most_bytes:
            while self._cheapest[0][-1] not in self._waiting:
                heappop(self._cheapest)
            return self._waiting[self._cheapest[0][-1]]
        return None

    def _evict(self, waiting: Waiting, reason: str) -> Evicted:
        self._remove(waiting)
        return Evicted(waiting.sample, reason, waiting.key)

    def _add(self, waiting: Waiting) -> None:
        self._waiting[waiting.sample] = waiting
        self._keys.setdefault(waiting.key, {})[waiting.sample] = waiting
        self._bytes += min(waiting.size, self._most_bytes / 2)
        heappush(self._order, place(waiting))
        if len(self._order) > 2 * len(self) + 1:
            self._order = sorted(place(w) for w in self if w.sample not in self._resting)
        heappush(self._cheapest, _cheapness(waiting))
        if len(self._cheapest) > 2 * len(self) + 1:
            self._cheapest = sorted(map(_cheapness, self))

    def _remove(self, waiting: Waiting) -> None:
        del self._waiting[waiting.sample]
        self._resting.pop(waiting.sample, None)
        same = self._keys[waiting.key]
        del same[waiting.sample]
        if not same:
            del self._keys[waiting.key]
        self._bytes -= min(waiting.size, self._most_bytes / 2)


def _cheapness(waiting: Waiting) -> tuple[float, float, int]:
    return waiting.worth, waiting.t_gen, waiting.sample


def place(waiting: Waiting) -> Place:
    """Return what orders the samples that wait."""
    return waiting.priority, waiting.t_gen, waiting.sample
