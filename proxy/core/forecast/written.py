"""Schedules that a spec gives, laid over what was seen of a stream."""

from collections.abc import Sequence
from math import inf
from statistics import median

from planner.errors import ProblemError
from proxy.core.forecast.patterns import Memoryless, Pattern, Periodic, Span
from proxy.core.forecast.rhythm import Numbered, Rhythm, fit
from proxy.core.forecast.tuning import TUNING
from utility_specs.schedules import PeriodicRule, PoissonRule, PythonRule, ScheduleRule, TimesRule
from utility_specs.specs import Failures


class Listed(Pattern):
    """The times of a list, begun at `origin` [s]; the last sample came at `last` [s]."""

    def __init__(self, rule: TimesRule, origin: float, last: float) -> None:
        gaps = rule.gaps
        super().__init__("times", sum(gaps) / max(1, len(gaps)), 0.0, max(gaps, default=0.0))
        self._rule = rule
        self._origin = origin
        self._last = last

    def expect(self, span: Span) -> list[float]:
        """Return the listed times; one that has just come is not expected again."""
        early = 0.5 * min(self._rule.gaps, default=0.0)
        number = self._rule.first_after(max(span.after, self._last + early) - self._origin)
        times: list[float] = []
        while len(times) < span.most and (t := self._origin + self._rule.at(number)) <= span.until:
            times.append(t)
            number += 1
        return times


class Computed(Pattern):
    """What a Python function expects, asked anew after each sample."""

    def __init__(self, rule: PythonRule, times: Sequence[float], period: float, failures: Failures) -> None:
        super().__init__("python", period, 0.0, period)
        self._rule = rule
        self._times = times
        self._failures = failures
        self._until = times[-1]
        self._answer: list[float] = []

    def expect(self, span: Span) -> list[float]:
        """Return what the function says; nothing, and that is counted, where it fails."""
        if span.until > self._until:
            self._until = span.until + (span.until - span.now)
            first = self._times[0]
            try:
                answer = self._rule.next_times([t - first for t in self._times], self._until - first)
                self._answer = [first + t for t in answer]
            except ProblemError:
                self._failures.note("schedule")
        return [t for t in self._answer if span.after < t <= span.until][: span.most]


def written(rule: ScheduleRule, past: Sequence[Numbered], period: float, failures: Failures) -> Pattern:
    """Return what a rule says of a stream with this past, its first sample first; `failures` counts failures."""
    match rule:
        case PeriodicRule():
            return Periodic(_rhythm(rule, past))
        case PoissonRule():
            return Memoryless(rule.interval)
        case TimesRule():
            return Listed(rule, _origin(rule, past), past[-1][1])
        case PythonRule():
            return Computed(rule, [t for _, t in past], period, failures)


def _rhythm(rule: PeriodicRule, past: Sequence[Numbered]) -> Rhythm:
    """Return the rhythm of the last samples with the period, and perhaps the phase, that is written."""
    first, last, period = past[0][1], past[-1][1], rule.period
    if rule.phase is not None:
        start = first + rule.phase
        number = round((last - start) / period)
        return Rhythm(period, start + number * period, number, 0.0, len(past))
    recent = past[-2 * TUNING.rule_recent :]
    numbers = [round((t - last) / period) for _, t in recent]
    return fit([(n, t) for n, (_, t) in zip(numbers, recent, strict=True)], period) or Rhythm(period, last, 0, 0.0, 1)


def _origin(rule: TimesRule, past: Sequence[Numbered]) -> float:
    """Return when the list began: by the number of the first sample known, then by the samples near listed times."""
    count, first = past[0]
    begun = rule.at(count - 1)
    origin = first - (begun if begun < inf else 0.0)
    return origin + median([_off(rule, t - origin) for _, t in past[-TUNING.rule_recent :]])


def _off(rule: TimesRule, elapsed: float) -> float:
    """How far a time is from the nearest listed one [s]."""
    number = rule.first_after(elapsed)
    return min((elapsed - rule.at(n) for n in (number - 1, number) if n >= 0), key=abs)
