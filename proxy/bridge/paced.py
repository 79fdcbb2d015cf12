"""Samples that were decided wait for their pace; what is small does not wait for what is large."""

from collections import Counter, deque

from proxy.bridge.sample import Held
from proxy.bridge.tuning import TUNING

Item = tuple[int | str, Held]
"""A decided sample with its number, or a passing one with its reason."""


class Paced:
    """Two lanes, each in order. Large samples wait for all that went before, small ones for small ones only.

    What both lanes send together counts for the large ones, so in the long run all keep the pace `rate` [B/s] (None:
    unpaced). Samples of one key stay in order. Not for several threads at once.
    """

    def __init__(self, rate: float | None) -> None:
        self._rate = rate
        self._small: deque[Item] = deque()
        self._large: deque[Item] = deque()
        self._large_keys: Counter[tuple[str, str]] = Counter()
        self._small_free_at = self._free_at = 0.0
        """When the next small or any sample may go [s]."""

    def __len__(self) -> int:
        return len(self._small) + len(self._large)

    @property
    def unpaced(self) -> bool:
        """Whether samples go as fast as they can."""
        return self._rate is None

    def pace(self, rate: float | None) -> None:
        """Keep another rate from now on [B/s]; None: none."""
        self._rate = rate

    def free(self, now: float, air: int) -> bool:
        """Whether a sample that puts `air` bytes on the air need not wait."""
        free_at = self._small_free_at if self._is_small(air) else self._free_at
        return not self._small and not self._large and (self._rate is None or free_at <= now)

    def put(self, number: int | str, held: Held, air: int) -> None:
        """Let a sample wait that puts `air` bytes on the air."""
        key = held.to, held.key
        if self._is_small(air) and key not in self._large_keys:
            self._small.append((number, held))
        else:
            self._large.append((number, held))
            self._large_keys[key] += 1

    def due(self) -> float | None:
        """When the next sample may go [s]; None: none waits."""
        times = [at for lane, at in ((self._small, self._small_free_at), (self._large, self._free_at)) if lane]
        return None if not times else 0.0 if self._rate is None else min(times)

    def ripe(self, now: float) -> bool:
        """Whether a sample may go."""
        if not self._small and not self._large:  # asked for every sample that passes
            return False
        due = self.due()
        return due is not None and due <= now

    def take(self, now: float) -> Item | None:
        """Take the next sample, if one may go."""
        if not self.ripe(now):
            return None
        if self._small and (self._rate is None or self._small_free_at <= now):
            return self._small.popleft()
        number, held = self._large.popleft()
        key = held.to, held.key
        self._large_keys[key] -= 1
        if not self._large_keys[key]:
            del self._large_keys[key]
        return number, held

    def sent(self, now: float, air: int) -> None:
        """A decided sample went; the next one makes up for a little by which it was late."""
        if self._rate is None:
            return
        since = now - TUNING.made_up
        self._free_at = max(self._free_at, since) + air / self._rate
        if self._is_small(air):
            self._small_free_at = max(self._small_free_at, since) + air / self._rate

    def catch_up(self, now: float) -> None:
        """All that went has left: nobody need wait for it."""
        self._free_at = min(self._free_at, now)
        self._small_free_at = min(self._small_free_at, now)

    def push_back(self, now: float, air: int, most: float) -> None:
        """Something else went: what is decided waits for it, too, but no longer than `most` [s]."""
        if self._rate is not None:
            pushed = max(self._free_at, now) + air / self._rate
            self._free_at = max(self._free_at, min(pushed, now + most))

    def _is_small(self, air: int) -> bool:
        return self._rate is not None and air <= TUNING.quick_sample * self._rate
