"""Samples that wait for room behind others: what comes later and uses no less finds none before those do.

So only leaders are looked at when room opens; with all 256 a daemon with 100 streams of 30 samples/s did nothing else.
"""

import math
from collections.abc import Hashable
from operator import ge
from typing import NamedTuple

from proxy.core.model.waiting import Waiting
from proxy.core.samples.inbox import Inbox, Place, place


class _Entry(NamedTuple):
    place: Place
    key: str
    """Samples of one key go in order, however each stands."""
    kind: Hashable
    """Samples of one kind find room in the same way."""
    use: tuple[float, ...]
    opens_at: float = math.inf
    """When there is room for it [s], if it leads."""


class Followers:
    """The leaders among the samples of an inbox that rest, and who follows each of them."""

    def __init__(self, inbox: Inbox) -> None:
        self._inbox = inbox
        self._leaders: dict[int, _Entry] = {}
        self._following: dict[int, dict[Place, _Entry]] = {}
        """Those that rest behind each leader, and some that left."""
        self._keys: dict[str, dict[Place, int]] = {}
        """The same by key: the place of each, and the number of its leader."""

    def __bool__(self) -> bool:
        return bool(self._leaders)

    def lead(self, kind: Hashable, sample: Waiting, use: tuple[float, ...], opens_at: float) -> None:
        """A sample waits until there is room for it, at that time [s]."""
        self._leaders[sample.sample] = _Entry(place(sample), sample.key, kind, use, opens_at)

    def follow(self, kind: Hashable, sample: Waiting, use: tuple[float, ...]) -> float | None:
        """Let a sample wait behind another one; return before when there is no room for it [s]. None: behind nobody."""
        leader = self._follow(_Entry(place(sample), sample.key, kind, use))
        return None if leader is None else leader.opens_at

    def release(self) -> None:
        """Of those whose leaders left, the ones that lead now may be taken."""
        for number in [number for number in self._leaders if number not in self._inbox]:
            del self._leaders[number]
            followed = sorted(self._following.pop(number, {}).values())
            for entry in followed:
                self._forget(entry.key, entry.place)
            for entry in followed:
                if self._inbox.rests_until(entry.place[-1]) is not None and self._follow(entry) is None:
                    self._inbox.wake_one(entry.place[-1])
                    self._leaders[entry.place[-1]] = entry._replace(opens_at=-math.inf)

    def clear(self) -> None:
        """Nobody follows anybody any more."""
        self._leaders.clear()
        self._following.clear()
        self._keys.clear()

    def _follow(self, entry: _Entry) -> _Entry | None:
        number = self._leader_of(entry)
        if number is None:
            return None
        self._forget(entry.key, entry.place)
        self._following.setdefault(number, {})[entry.place] = entry
        self._keys.setdefault(entry.key, {})[entry.place] = number
        return self._leaders[number]

    def _leader_of(self, entry: _Entry) -> int | None:
        """Return the number of the sample behind which one rests: one of its key, or that which such a one follows."""
        if (number := self._followed_by_its_key(entry)) is not None:
            return number
        for number, leader in self._leaders.items():
            if leader.place < entry.place:
                alike = entry.kind == leader.kind
                if leader.key == entry.key or (alike and all(map(ge, entry.use, leader.use))):
                    return number
        return None

    def _followed_by_its_key(self, entry: _Entry) -> int | None:
        """Return whom one of its key follows that comes before it; those before that one that left are forgotten."""
        found, gone = None, []
        for at, number in self._keys.get(entry.key, {}).items():
            if self._inbox.rests_until(at[-1]) is None:
                gone.append(at)
            elif at < entry.place and number in self._leaders:
                found = number
                break
        for at in gone:
            self._forget(entry.key, at)
        return found

    def _forget(self, key: str, at: Place) -> None:
        """One follows nobody any more."""
        same = self._keys.get(key, {})
        self._following.get(same.pop(at, -1), {}).pop(at, None)
        if not same:
            self._keys.pop(key, None)
