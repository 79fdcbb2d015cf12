"""Records as figures: shares of the bound and of the maximum, means over missions with their confidence intervals."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from statistics import fmean, stdev

from studies.oracle.scipy import load
from studies.study.programme import bound_of, normal
from studies.study.store import Record, Store
from studies.study.tasks import Task

CONFIDENCE = 0.95


@dataclass(frozen=True, slots=True)
class Mean:
    """The mean of `count` values, and how far the true one may lie from it with `CONFIDENCE`; None: one value."""

    mean: float
    half: float | None
    count: int

    @classmethod
    def of(cls, values: Sequence[float]) -> "Mean":
        """Return the mean of some values, at least one."""
        count = len(values)
        if count < 2:
            return cls(fmean(values), None, count)
        factor = float(load("stats").t.ppf((1.0 + CONFIDENCE) / 2.0, count - 1))
        return cls(fmean(values), factor * stdev(values) / count**0.5, count)

    @property
    def above_nothing(self) -> bool:
        """Whether it is greater than 0 beyond its confidence interval."""
        return self.half is not None and self.mean - self.half > 0.0

    @property
    def below_nothing(self) -> bool:
        """Whether it is less than 0 beyond its confidence interval."""
        return self.half is not None and self.mean + self.half < 0.0

    def percent(self, digits: int = 1) -> str:
        """Write it in per cent."""
        spread = "" if self.half is None else f" ± {100 * self.half:.{digits}f}"
        return f"{100 * self.mean:.{digits}f}{spread}"


@dataclass(frozen=True, slots=True)
class Results:
    """What is known of tasks; everything else is computed from it."""

    store: Store

    def record(self, task: Task) -> Record | None:
        """Return the record of a task, if it was flown."""
        task = normal(task)
        return self.store.get(task)

    def share(self, task: Task) -> float | None:
        """Return the utility as a part of the bound of the mission at the same latency."""
        own, bound = self.record(task), self.record(bound_of(task))
        return None if own is None or bound is None else float(own["utility"] / bound["utility"])

    def of_maximum(self, task: Task) -> float | None:
        """Return the utility as a part of what all messages without delay are worth."""
        own = self.record(task)
        return None if own is None else float(own["utility"] / own["maximum"])

    def sent(self, task: Task) -> float | None:
        """Return the part of messages that was sent."""
        own = self.record(task)
        return None if own is None else float(own["sent"] / own["generated"])

    def received(self, task: Task) -> float | None:
        """Return the part of messages that was received."""
        own = self.record(task)
        return None if own is None else float(own["received"] / own["generated"])

    def mean(self, tasks: Iterable[Task], what: Callable[[Task], float | None]) -> Mean | None:
        """Return the mean of a figure over the tasks that were flown; None of none."""
        known = [value for task in tasks if (value := what(task)) is not None]
        return Mean.of(known) if known else None

    def ahead(self, pairs: Iterable[tuple[Task, Task]]) -> Mean | None:
        """Return by how much the first of each pair reaches more of the bound than the second, mission by mission."""
        differences = []
        for one, other in pairs:
            a, b = self.share(one), self.share(other)
            if a is not None and b is not None:
                differences.append(a - b)
        return Mean.of(differences) if differences else None
