"""What an operator writes for when a stream generates; `auto` finds it out."""

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, ValidationInfo, field_validator, model_validator

from planner.errors import ProblemError
from utility_specs.imports import imported
from utility_specs.units import Age, Duration, Frequency

MOST_TIMES = 1000
"""Times that a spec may list."""
TRIED = (0.0, 1.0, 2.0)
"""Generation times that a Python function is tried with [s]."""


@dataclass(frozen=True, slots=True)
class PeriodicRule:
    """One sample every `period` [s], `phase` [s] after the stream's first one; None: as the samples tell."""

    period: float
    phase: float | None = None


@dataclass(frozen=True, slots=True)
class PoissonRule:
    """Samples at random moments, `interval` [s] apart on average."""

    interval: float


@dataclass(frozen=True, slots=True)
class TimesRule:
    """Samples at `times` [s], counted from the stream's first one; again and again `every` so long [s], or once."""

    times: tuple[float, ...]
    every: float | None = None

    def at(self, number: int) -> float:
        """When sample number `number`, from 0 on, is generated [s]; infinite when there is none."""
        cycle, place = divmod(number, len(self.times))
        if cycle and self.every is None:
            return math.inf
        return self.times[place] - self.times[0] + cycle * (self.every or 0.0)

    def first_after(self, elapsed: float) -> int:
        """Return the number of the first sample generated later than `elapsed` [s]."""
        cycle = max(0, math.floor(elapsed / self.every)) if self.every else 0
        within = elapsed - cycle * (self.every or 0.0)
        return cycle * len(self.times) + bisect_right(self.times, within + self.times[0])

    @property
    def gaps(self) -> tuple[float, ...]:
        """The times between each and the next [s]; none for a single one that is not repeated."""
        again = (self.times[0] + self.every,) if self.every else ()
        return tuple(b - a for a, b in pairwise((*self.times, *again)))


@dataclass(frozen=True, slots=True)
class PythonRule:
    """What a Python function says: it takes past times and until when, and returns the times to come."""

    path: str
    function: Callable[[Sequence[float], float], Any]

    def next_times(self, times: Sequence[float], until: float) -> list[float]:
        """Return when samples are expected after the last of `times` and until `until` [s], in order.

        Raises ProblemError when the function fails or returns anything else.
        """
        try:
            answer = sorted(map(float, self.function(list(times), until)))
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            raise ProblemError(f"{self.path} failed: {type(error).__name__}: {error}") from error
        if not all(map(math.isfinite, answer)):
            raise ProblemError(f"{self.path} returned a time that is not finite")
        return [t for t in answer if times[-1] < t <= until]


ScheduleRule = PeriodicRule | PoissonRule | TimesRule | PythonRule
"""How a spec says that the streams of a type generate."""


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


class PeriodicTable(_Table):
    """One sample every `period`, `phase` after the first one, or as the samples tell."""

    kind: Literal["periodic"]
    period: Duration = Field(description="the time from sample to sample")
    phase: Age | None = Field(
        default=None, description="when, after the stream's first sample; found out unless it is given"
    )

    def rule(self) -> ScheduleRule:
        """Return the rule."""
        return PeriodicRule(self.period, None if self.phase is None else self.phase % self.period)


class PoissonTable(_Table):
    """Samples at random moments, at a `rate` or a mean `interval` apart."""

    kind: Literal["poisson"]
    rate: Frequency | None = Field(default=None, description="how many samples there are on average")
    interval: Duration | None = Field(default=None, description="how far apart they are on average")

    @model_validator(mode="after")
    def _either(self) -> "PoissonTable":
        if (self.rate is None) == (self.interval is None):
            raise ValueError('needs one of rate (such as "0.2 Hz") and interval (such as "5 s")')
        return self

    def rule(self) -> ScheduleRule:
        """Return the rule."""
        return PoissonRule(1.0 / self.rate if self.rate else self.interval or 0.0)


class TimesTable(_Table):
    """Samples at `times` after the first of them, again `every` so long."""

    kind: Literal["times"]
    times: Annotated[list[Age], Field(min_length=1, max_length=MOST_TIMES)] = Field(
        description="when, after the first of them"
    )
    every: Duration | None = Field(default=None, description="again and again so long after; once unless it is given")

    @field_validator("times")
    @classmethod
    def _rising(cls, times: list[float]) -> list[float]:
        for before, after in pairwise(times):
            if after <= before:
                raise ValueError(f"must rise, not have {after:g} s after {before:g} s")
        return times

    @field_validator("every")
    @classmethod
    def _longer(cls, every: float | None, info: ValidationInfo) -> float | None:
        times = info.data.get("times")
        if times and every is not None and every <= times[-1] - times[0]:
            raise ValueError(f"must be more than the {times[-1] - times[0]:g} s from the first to the last of times")
        return every

    def rule(self) -> ScheduleRule:
        """Return the rule."""
        return TimesRule(tuple(self.times), self.every)


class PythonScheduleTable(_Table):
    """What a Python function `package.module:name` says."""

    kind: Literal["python"]
    function: str = Field(
        description="package.module:name; it gets past times and until when, and returns times to come"
    )

    @field_validator("function")
    @classmethod
    def _importable(cls, path: str) -> str:
        imported(path)
        return path

    def rule(self) -> ScheduleRule:
        """Return the rule, tried with three samples a second apart; raises ProblemError when the function fails."""
        rule = PythonRule(self.function, imported(self.function))
        rule.next_times(TRIED, 10.0)
        return rule


_AnyTable = Annotated[
    PeriodicTable | PoissonTable | TimesTable | PythonScheduleTable,
    Field(discriminator="kind"),
]


def _form(value: Any) -> str:
    return "table" if isinstance(value, dict | _Table) else "name"


AnySchedule = Annotated[
    Annotated[Literal["auto"], Tag("name")] | Annotated[_AnyTable, Tag("table")], Discriminator(_form)
]
"""`auto`, or a table for what is known."""


def rule_of(said: "str | PeriodicTable | PoissonTable | TimesTable | PythonScheduleTable") -> ScheduleRule | None:
    """Return the rule that a spec gives, None for `auto`; raises ProblemError when a function fails."""
    return None if isinstance(said, str) else said.rule()
