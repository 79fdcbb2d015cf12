"""Deletions of keys: each passes behind the samples that were published before it, and before those after it."""

from collections.abc import Iterable
from dataclasses import dataclass

from proxy.core.model.waiting import Waiting


@dataclass(frozen=True, slots=True)
class _Deletion:
    """A deletion of a key, and the undecided samples of it that go first."""

    sample: int
    key: str
    behind: frozenset[int]


class Deletions:
    """The deletions that wait, in the order in which they came."""

    def __init__(self) -> None:
        self._waiting: list[_Deletion] = []

    def add(self, sample: int, key: str, undecided: Iterable[Waiting]) -> None:
        """A deletion came; it waits for those of the undecided samples that are of its key."""
        self._waiting.append(_Deletion(sample, key, frozenset(w.sample for w in undecided if w.key == key)))

    def holds(self, waiting: Waiting) -> bool:
        """Whether a sample came after a deletion of its key that did not pass yet."""
        return any(d.key == waiting.key and waiting.sample not in d.behind for d in self._waiting)

    def due(self, undecided: Iterable[Waiting]) -> list[int]:
        """Remove and return the deletions that have nothing before them any more."""
        if not self._waiting:
            return []
        still = {w.sample for w in undecided}
        passing = [d for d in self._waiting if d.behind.isdisjoint(still)]
        self._waiting = [d for d in self._waiting if not d.behind.isdisjoint(still)]
        return [d.sample for d in passing]
