"""What the decisions came to: how many, how good they are known to be, what bound them, and why the last one."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from planner import Plan

ROUNDING = 1e-9
"""A plan whose utility may be exceeded by no more than this part of it is the best."""


@dataclass(frozen=True, slots=True)
class Decided:
    """A decision at `now` [s] on a sample of `key`; `reason` is what became of it, `constraints` are the problem's."""

    now: float
    key: str
    plan: Plan
    constraints: tuple[str, ...]
    reason: str

    @property
    def proven(self) -> bool:
        """Whether no plan is better."""
        gap = self.plan.gap
        return gap is not None and gap <= ROUNDING * max(1.0, abs(self.plan.utility))

    def described(self, now: float) -> dict[str, Any]:
        """The decision as plain JSON data: its `age` [s], and the plan that led to it [utility·s]."""
        plan = self.plan
        return {
            "age": now - self.now,
            "key": self.key,
            "send": plan.send,
            "reason": self.reason,
            "utility": plan.utility,
            "opposite": plan.opposite,
            "lead": plan.lead,
            "gap": plan.gap,
            "iterations": plan.iterations,
            "nodes": plan.nodes,
            "seconds": plan.seconds,
            "binding": list(plan.binding),
            "prices": dict(zip(self.constraints, plan.prices, strict=False)),
        }


class Decisions:
    """Statistics of all decisions since the start.

    `gap` sums by how much the plans may be exceeded at most, `utility` what they are worth, both over the `bounded`
    ones, whose gap is known [utility·s]. `unneeded` are samples that were sent while there was room for all.
    `undisputed` ones were sent and `hopeless` ones dropped by what
    room costs. A guarantee demanded the `owed` ones; for the `unkept` of them the limits left no room. `late` are
    samples that were sent if they fitted, for there was no answer in time. Of windows that were `thinned` to come in
    time `kept` counts the messages to decide, `full` those there would be else. `binding` counts by constraint the
    dropped samples that it was in the way of.
    """

    def __init__(self) -> None:
        self.made = 0
        self.iterations = 0
        self.would_drop = 0
        self.unneeded = 0
        self.undisputed = 0
        self.hopeless = 0
        self.owed = 0
        self.unkept = 0
        self.late = 0
        self.thinned = 0
        self.kept = 0
        self.full = 0
        self.seconds = 0.0
        self.longest = 0.0
        self.proven = 0
        self.bounded = 0
        self.gap = 0.0
        self.utility = 0.0
        self.binding: Counter[str] = Counter()
        self.last: Decided | None = None

    def note(self, decided: Decided) -> None:
        """A search has decided."""
        plan, self.last = decided.plan, decided
        self.made += 1
        self.iterations += plan.iterations
        self.seconds += plan.seconds or 0.0
        self.longest = max(self.longest, plan.seconds or 0.0)
        self.proven += decided.proven
        if plan.gap is not None:
            self.bounded += 1
            self.gap += plan.gap
            self.utility += plan.utility
        if not plan.send:
            self.binding.update(plan.binding)

    def thin(self, kept: int, full: int) -> None:
        """A window holds so many messages to decide, instead of all."""
        self.thinned += 1
        self.kept += kept
        self.full += full

    def refused(self, lacking: Iterable[str]) -> None:
        """A sample was dropped for want of room in these constraints."""
        self.binding.update(lacking)

    def described(self, now: float) -> dict[str, Any]:
        """All of it as plain JSON data; `seconds` and `longest` in seconds."""
        return {
            "made": self.made,
            "iterations": self.iterations,
            "would_drop": self.would_drop,
            "unneeded": self.unneeded,
            "undisputed": self.undisputed,
            "hopeless": self.hopeless,
            "owed": self.owed,
            "unkept": self.unkept,
            "late": self.late,
            "thinned": {"windows": self.thinned, "messages": self.kept, "of": self.full},
            "seconds": self.seconds,
            "longest": self.longest,
            "proven": self.proven,
            "bounded": self.bounded,
            "gap": self.gap,
            "utility": self.utility,
            "binding": dict(self.binding.most_common()),
            "last": None if self.last is None else self.last.described(now),
        }
