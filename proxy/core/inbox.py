"""The samples that wait for a decision, bounded. Of a Markovian stream only the latest does."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field

SUPERSEDED = "dropped:superseded"


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
    """A sample that had to leave the inbox, its key, and why."""

    sample: int
    reason: str
    key: str


class Inbox:
    """Gives out the highest priority first, then the oldest.

    At most `capacity` samples wait in all. Where each sample of a stream counts, at most `backlog` of it do.
    """

    def __init__(self, capacity: int, backlog: int) -> None:
        self._capacity = capacity
        self._backlog = backlog
        self._waiting: dict[int, Waiting] = {}

    def __len__(self) -> int:
        return len(self._waiting)

    def __iter__(self) -> Iterator[Waiting]:
        return iter(self._waiting.values())

    def put(self, new: Waiting) -> list[Evicted]:
        """Queue a sample; return those that had to leave for it (the new one may be among them)."""
        superseded = [self._evict(w, SUPERSEDED) for w in self._of(new.key) if new.markovian]
        self._waiting[new.sample] = new
        least = self._least(new.key)
        return superseded if least is None else [*superseded, self._evict(least, "dropped:overflow")]

    def supersede(self, key: str) -> list[Evicted]:
        """Remove what waits of a Markovian stream, because something newer came; return it."""
        return [self._evict(w, SUPERSEDED) for w in self._of(key) if w.markovian]

    def clear(self) -> list[Waiting]:
        """Remove and return all that waits."""
        taken, self._waiting = list(self), {}
        return taken

    def put_back(self, taken: Iterable[Waiting]) -> None:
        """Queue what was taken out before; nothing leaves for it."""
        self._waiting |= {waiting.sample: waiting for waiting in taken}

    def take(self, held: Callable[[Waiting], bool] = lambda _: False) -> Waiting | None:
        """Remove and return the next sample to decide; one that is `held` back has to wait."""
        if not self._waiting:
            return None
        ready = [w for w in self._waiting.values() if not held(w)]
        if not ready:
            return None
        return self._waiting.pop(min(ready, key=lambda w: (w.priority, w.t_gen, w.sample)).sample)

    def _of(self, key: str) -> list[Waiting]:
        return [w for w in self if w.key == key]

    def _least(self, key: str) -> Waiting | None:
        """Return what has to leave: the least valuable of a key with too many, else the least per byte of all."""
        same = self._of(key)
        if len(same) > self._backlog:
            return min(same, key=lambda w: (w.scale, w.t_gen, w.sample))
        if len(self) > self._capacity:
            return min(self, key=lambda w: (w.worth, w.t_gen, w.sample))
        return None

    def _evict(self, waiting: Waiting, reason: str) -> Evicted:
        del self._waiting[waiting.sample]
        return Evicted(waiting.sample, reason, waiting.key)
