"""The samples that wait for a decision: bounded, and the latest of a Markovian stream wins."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Waiting:
    """A sample in the inbox. `worth` orders evictions: value per byte; `priority` is Zenoh's, 1 the highest."""

    sample: int
    key: str
    size: int
    t_gen: float
    scale: float
    priority: int
    markovian: bool
    features: Mapping[str, float] = field(default_factory=dict)

    @property
    def worth(self) -> float:
        """Value per byte."""
        return self.scale / max(self.size, 1)


@dataclass(frozen=True, slots=True)
class Evicted:
    """A sample that had to leave the inbox, and why."""

    sample: int
    reason: str


class Inbox:
    """Gives out the highest priority first, then the oldest."""

    def __init__(self, capacity: int) -> None:
        self._capacity = capacity
        self._waiting: dict[int, Waiting] = {}
        self._latest: dict[str, int] = {}

    def __len__(self) -> int:
        return len(self._waiting)

    def __iter__(self) -> Iterator[Waiting]:
        return iter(self._waiting.values())

    def put(self, new: Waiting) -> Evicted | None:
        """Queue a sample; return the one that had to leave for it, if any (it may be the new one)."""
        if new.markovian and new.key in self._latest:
            old = self._remove(self._latest[new.key])
            self._add(new)
            return Evicted(old.sample, "dropped:superseded")
        self._add(new)
        if len(self._waiting) <= self._capacity:
            return None
        least = min(self._waiting.values(), key=lambda w: (w.worth, w.t_gen, w.sample))
        self._remove(least.sample)
        return Evicted(least.sample, "dropped:overflow")

    def evict(self, key: str) -> Evicted | None:
        """Remove the waiting sample of a Markovian stream; return it, if there was one."""
        if key not in self._latest:
            return None
        return Evicted(self._remove(self._latest[key]).sample, "dropped:superseded")

    def take(self) -> Waiting | None:
        """Remove and return the next sample to decide."""
        if not self._waiting:
            return None
        first = min(self._waiting.values(), key=lambda w: (w.priority, w.t_gen, w.sample))
        return self._remove(first.sample)

    def _add(self, new: Waiting) -> None:
        self._waiting[new.sample] = new
        if new.markovian:
            self._latest[new.key] = new.sample

    def _remove(self, sample: int) -> Waiting:
        gone = self._waiting.pop(sample)
        if self._latest.get(gone.key) == sample:
            del self._latest[gone.key]
        return gone
