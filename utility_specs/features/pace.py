"""How often costly features are computed: on average, none takes more than its budget for a sample of a stream.

What a computation took is told by whoever has a clock.
"""

from collections import Counter, OrderedDict
from dataclasses import dataclass
from threading import Lock

STREAMS = 256
"""Streams of each feature whose pace is kept."""

_NEW = 0.5
"""The part of the newest cost in the smoothed one."""


@dataclass(slots=True)
class Pace:
    """What a feature takes in one stream, and whether it is time to compute it again."""

    value: float
    """What was computed last; the default before that."""
    cost: float | None = None
    """What a computation takes, smoothed; in a new stream as in the others, so that it holds up nobody [s]."""
    saved: float = 0.0
    """What the samples since the last computation have saved of their budgets [s]."""
    under_way: bool = False
    """Whether a computation has begun, or waits, that `took` will end."""

    def quick(self, budget: float) -> bool:
        """Whether a computation is known to take no longer than `budget` [s]."""
        return self.cost is not None and self.cost <= budget

    def due(self, budget: float) -> bool:
        """Let one more sample save its budget; return whether a computation may begin that `took` will end."""
        self.saved += budget
        if self.under_way or self.saved < (self.cost or 0.0):
            return False
        self.under_way = True
        return True

    def took(self, cost: float, value: float) -> None:
        """Note what was computed, and what that took [s]."""
        self.cost = cost if self.cost is None else self.cost + _NEW * (cost - self.cost)
        self.value, self.saved, self.under_way = value, 0.0, False

    def refused(self) -> None:
        """Note that a computation that was due cannot be made now."""
        self.under_way = False


class Paces:
    """The paces of all features of an information type, each stream with its own."""

    def __init__(self) -> None:
        self._paces: dict[str, OrderedDict[str, Pace]] = {}
        self._held: Counter[str] = Counter()
        self._lock = Lock()
        self.evicted = 0
        """Streams whose pace was forgotten, because there are more than `STREAMS`."""

    def of(self, feature: str, key: str, default: float) -> Pace:
        """Return the pace of a feature in the stream of a key."""
        with self._lock:
            paces = self._paces.setdefault(feature, OrderedDict())
            pace = paces.get(key)
            if pace is None:
                known = max((each.cost for each in paces.values() if each.cost is not None), default=None)
                pace = paces[key] = Pace(default, known, known or 0.0)
            paces.move_to_end(key)
            if len(paces) > STREAMS:
                paces.popitem(last=False)
                self.evicted += 1
            return pace

    def hold(self, feature: str) -> None:
        """Count a sample that an older value of a feature stands in for."""
        with self._lock:
            self._held[feature] += 1

    def held(self) -> dict[str, int]:
        """Return how many samples an older value stood in for, by feature; none are left out."""
        with self._lock:
            return dict(self._held)

    def costs(self) -> dict[str, float]:
        """Return what each feature takes in the stream where it takes longest [s]."""
        with self._lock:
            return {
                feature: max(costs)
                for feature, paces in self._paces.items()
                if (costs := [pace.cost for pace in paces.values() if pace.cost is not None])
            }
