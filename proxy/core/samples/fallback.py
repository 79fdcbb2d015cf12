"""What decides when the planner fails: priority, and token buckets for all that is not urgent.

What is not urgent takes a part of what the limits leave, as specs say: a bucket for each holds that part of a window.
"""

from collections.abc import Sequence

from planner import Constraint
from proxy.core.coordination.budget import Budget
from proxy.core.model.waiting import Waiting
from proxy.core.view.view import SharedView


class TokenBuckets:
    """A bucket for each limit; full at first."""

    def __init__(self) -> None:
        self._buckets: dict[str, tuple[float, float]] = {}
        """What each holds at most, and what it holds."""
        self._filled = 0.0

    def fill(self, now: float, limits: Sequence[Constraint], sizes: Sequence[float]) -> None:
        """Let time pass: in a window, samples that are not urgent may now take so much of each limit."""
        elapsed, self._filled = max(0.0, now - self._filled), now
        before = self._buckets
        self._buckets = {
            limit.name: (size, min(size, before.get(limit.name, (size, size))[1] + size * elapsed / limit.window))
            for limit, size in zip(limits, sizes, strict=True)
        }

    def lacking(self, use: Sequence[float]) -> tuple[str, ...]:
        """Return the limits whose buckets hold less than a sample uses; for a large one they need only be full."""
        buckets = self._buckets.items()
        return tuple(
            name for (name, (size, level)), amount in zip(buckets, use, strict=True) if level < min(amount, size)
        )

    def take(self, use: Sequence[float]) -> None:
        """A sample was sent; after a large one buckets hold less than nothing for a while."""
        self._buckets = {
            name: (size, level - amount)
            for (name, (size, level)), amount in zip(self._buckets.items(), use, strict=True)
        }


class StaticRule:
    """Decides by priority and token buckets, within the limits."""

    def __init__(self, view: SharedView, budget: Budget) -> None:
        self._view = view
        self._budget = budget
        self._buckets = TokenBuckets()

    def needed(self, sample: Waiting, use: Sequence[float]) -> tuple[float, ...]:
        """What room there has to be for a sample that uses so much: the lower ones leave a part of it."""
        part = 1.0 if self._urgent(sample) else self._view.specs.fallback.part
        return tuple(amount / part for amount in use)

    def admit(self, now: float, sample: Waiting, use: Sequence[float]) -> tuple[str, ...]:
        """Name what has no room for a sample; if nothing has too little it is sent, and takes its tokens."""
        part, budget = self._view.specs.fallback.part, self._budget
        ours = [max(0.0, room + budget.used(now, k)) for k, room in enumerate(budget.free(now))]
        self._buckets.fill(now, budget.limits, [part * room for room in ours])
        lacking = budget.lacking(now, tuple(use), self.needed(sample, use))
        if lacking or self._urgent(sample):
            return lacking
        lacking = self._buckets.lacking(use)
        if not lacking:
            self._buckets.take(use)
        return lacking

    def _urgent(self, sample: Waiting) -> bool:
        return sample.priority <= self._view.specs.fallback.urgent
