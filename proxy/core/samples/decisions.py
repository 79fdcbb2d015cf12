"""Statistics of the decisions: how many there were, how good they are known to be, and what bound them."""

from collections import Counter
from collections.abc import Iterable
from enum import StrEnum
from typing import Any

from planner import Plan
from proxy.core.samples.decision_log import DecisionLog, Searched
from proxy.core.samples.tuning import TUNING

_OF_A_PLAN = ("send", "utility", "opposite", "lead", "gap", "iterations", "nodes", "seconds")


def is_proven(plan: Plan) -> bool:
    """Whether no plan is better."""
    return plan.gap is not None and plan.gap <= TUNING.proven_gap * max(1.0, abs(plan.utility))


class Shortcut(StrEnum):
    """What is counted of samples besides what searches decided."""

    WOULD_DROP = "would_drop"
    """In `shadow` it went although it was decided against."""
    UNNEEDED = "unneeded"
    """Sent while there was room for all."""
    UNDISPUTED = "undisputed"
    """Sent by what room costs."""
    HOPELESS = "hopeless"
    """Dropped by what room costs."""
    CERTAIN = "certain"
    """Sent within the small part that a robot keeps whatever others say."""
    OWED = "owed"
    """Sent because a guarantee demanded it."""
    UNKEPT = "unkept"
    """A guarantee demanded it, and the limits left no room."""
    LATE = "late"
    """Sent if it fitted, for there was no answer in time."""


class Decisions:
    """Statistics of all decisions since the start.

    `gap` and `utility` are sums over the `bounded` plans [utility·s], `thinned` counts windows and messages, `binding`
    the dropped samples by constraint. `seconds` and `longest` are in seconds.
    """

    def __init__(self) -> None:
        self.made = self.iterations = self.proven = self.bounded = 0
        self.seconds = self.longest = self.gap = self.utility = 0.0
        self.shortcuts = dict.fromkeys(Shortcut, 0)
        self.thinned = Counter(windows=0, messages=0, of=0)
        self.binding: Counter[str] = Counter()
        self.last: tuple[float, str, str, Searched] | None = None
        """When it was made [s], the key of the sample, what became of that, and the search."""
        self.log = DecisionLog()

    def count(self, shortcut: Shortcut, samples: int = 1) -> None:
        """So many more samples went or were dropped so."""
        self.shortcuts[shortcut] += samples

    def note(self, now: float, key: str, reason: str, searched: Searched) -> None:
        """A search has decided on a sample of this key; the `reason` is what became of it."""
        plan, self.last = searched.plan, (now, key, reason, searched)
        self.made += 1
        self.iterations += plan.iterations
        self.seconds += plan.seconds or 0.0
        self.longest = max(self.longest, plan.seconds or 0.0)
        self.proven += is_proven(plan)
        if plan.gap is not None:
            self.bounded += 1
            self.gap += plan.gap
            self.utility += plan.utility
        if not plan.send:
            self.binding.update(plan.binding)

    def thin(self, messages: int, of: int) -> None:
        """A window holds so many messages to decide, instead of all."""
        self.thinned.update(windows=1, messages=messages, of=of)

    def refused(self, lacking: Iterable[str]) -> None:
        """A sample was dropped for want of room in these constraints."""
        self.binding.update(lacking)

    def described(self, now: float) -> dict[str, Any]:
        """All of it as plain JSON data."""
        sums = {name: value for name, value in vars(self).items() if isinstance(value, int | float)}
        return {
            **sums,
            **{shortcut.value: count for shortcut, count in self.shortcuts.items()},
            "thinned": dict(self.thinned),
            "binding": dict(self.binding.most_common()),
            "last": None if self.last is None else _described(now, *self.last),
        }


def _described(now: float, at: float, key: str, reason: str, searched: Searched) -> dict[str, Any]:
    """The last decision as plain JSON data: its `age` [s], and the plan that led to it [utility·s]."""
    plan = searched.plan
    return {
        "age": now - at,
        "key": key,
        "reason": reason,
        **{name: getattr(plan, name) for name in _OF_A_PLAN},
        "binding": list(plan.binding),
        "prices": dict(zip(searched.constraints, plan.prices, strict=False)),
    }
