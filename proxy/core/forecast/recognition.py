"""Which pattern a stream has: as a spec says, as its robot reports, or as was seen; periodic if in doubt."""

import math
from collections import deque
from collections.abc import Sequence
from itertools import pairwise
from math import inf, sqrt
from statistics import median

from planner.errors import ProblemError
from proxy.core.forecast.patterns import Bursts, Memoryless, Pattern, Periodic, Span, bursts_in, reported_bursts
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


class History:
    """The recent past of one stream."""

    def __init__(self) -> None:
        self.past: deque[Numbered] = deque(maxlen=TUNING.memory)
        self.first: Numbered | None = None
        """The first sample that was ever seen."""
        self.seen = 0
        """Samples seen in all."""
        self.longest_gap = 0.0
        """The longest gap that was no pause, which shrinks with time [s]."""
        self.pauses = 0
        """So many of the last gaps in a row were pauses."""
        self._resumed = -TUNING.memory

    @property
    def newest(self) -> Numbered:
        """The last sample seen; one before all others while there is none."""
        return self.past[-1] if self.past else (0, -math.inf)

    @property
    def resumed(self) -> bool:
        """Whether the last pause is part of the recent past."""
        return self.seen - self._resumed < TUNING.memory

    def note(self, sample: Numbered, *, paused: bool) -> None:
        """A sample comes after the last one, perhaps after a pause."""
        if self.past and not paused:
            (count, before), (number, t) = self.past[-1], sample
            self.longest_gap = max((t - before) / (number - count), TUNING.gap_fade * self.longest_gap)
        self.first = self.first or sample
        self.past.append(sample)
        self.seen += 1

    def note_gap(self, *, paused: bool) -> None:
        """The gap before the sample that is noted next was a pause, or none."""
        self.pauses = self.pauses + 1 if paused else 0
        if paused:
            self._resumed = self.seen

    def keep(self, last: int) -> None:
        """Forget all but so many of the last samples."""
        self.past = deque(list(self.past)[-last:] if last else [], maxlen=TUNING.memory)

    def forget_since(self, t: float) -> None:
        """Forget what was generated at this time or later."""
        self.past = deque([each for each in self.past if each[1] < t], maxlen=TUNING.memory)

    def restart(self) -> None:
        """Forget all times."""
        self.past.clear()
        self.first, self.longest_gap = None, 0.0


_UNSEEN = Failures()
"""Where no rule is given nobody looks at failures."""


class Recognition:
    """What is known of the kind of one stream besides its generation times."""

    def __init__(self) -> None:
        self._rule: ScheduleRule | None = None
        self._failures = _UNSEEN
        self._reported = "", 0.0
        self._bursts: Bursts | None = None
        self._bursts_at = 0
        """As so many samples had been seen bursts were last looked for."""
        self._spread = 0.0
        self._spread_at = -TUNING.memory
        self._periodic = True

    def set_rule(self, rule: ScheduleRule | None, failures: Failures) -> bool:
        """Go by a rule of a spec, or by what is seen; return whether that is another one."""
        self._failures = failures
        changes, self._rule = rule != self._rule, rule
        return changes

    def report(self, kind: str, period: float) -> bool:
        """Go by what the stream's robot reports; return whether that is news."""
        reported = kind, period
        changes, self._reported = reported != self._reported, reported
        return changes

    def pattern(self, seen: History, rhythm: Rhythm | None) -> Pattern | None:
        """Return the pattern of a stream of which at least one sample was seen; None while it is not known."""
        first, last = seen.first or seen.past[0], seen.past[-1][1]
        if self._rule is not None:
            past = [*([first] if first != seen.past[0] else []), *seen.past]
            return written(self._rule, past, rhythm.period if rhythm else 0.0, self._failures)
        kind, period = self._reported
        if kind == "poisson":
            return Memoryless(period)
        reported = reported_bursts(kind.split(), period, last) if kind.startswith("bursts") else None
        if rhythm is None:
            return reported
        pauses = seen.resumed or seen.longest_gap > TUNING.run * rhythm.period
        if pauses and kind != "periodic":
            self._bursts = self._bursts_in(seen, first, last)
            if self._bursts is not None:
                return self._bursts
        if reported is not None:
            return reported
        self._periodic = kind == "periodic" or self._has_rhythm(seen, rhythm)
        return Periodic(rhythm) if self._periodic else Memoryless(_mean_interval(seen))

    def _bursts_in(self, seen: History, first: Numbered, last: float) -> Bursts | None:
        """Return the bursts of the past; where one goes on, those known are not looked for again."""
        goes_on, self._bursts_at = self._bursts_at == seen.seen - 1, seen.seen
        joined = self._bursts.joined(last) if self._bursts is not None and goes_on else None
        return joined or bursts_in(seen.past, whole=seen.past[0] == first)

    def _has_rhythm(self, seen: History, rhythm: Rhythm) -> bool:
        """Whether the rhythm explains what was seen: a few samples always seem to have one."""
        hysteresis = TUNING.hysteresis if self._periodic else -TUNING.hysteresis
        if len(seen.past) <= TUNING.run + 1:
            return True
        if rhythm.looseness > TUNING.no_rhythm + hysteresis:
            return False
        if rhythm.known >= TUNING.sure:
            return True
        if seen.seen >= self._spread_at + TUNING.seldom or seen.seen < TUNING.sure:
            self._spread, self._spread_at = _spread(seen.past), seen.seen
        return self._spread < TUNING.random_spread + hysteresis


def _mean_interval(seen: History) -> float:
    """Return the mean time between two samples of the past, pauses left out [s].

    With them streams that began again seemed to send seldom: windows of four robots were over by up to 1.35 limits.
    """
    gaps = [(t - s, n - m) for (m, s), (n, t) in pairwise(seen.past)]
    usual = [(gap, count) for gap, count in gaps if gap <= TUNING.timeout_gaps * seen.longest_gap * count] or gaps
    return sum([gap for gap, _ in usual]) / sum([count for _, count in usual])


def _spread(points: Sequence[Numbered]) -> float:
    """Return the median deviation of gaps between numbered times as a part of their median: 0.7 if random."""
    gaps = [((t - s), n - m) for (m, s), (n, t) in pairwise(points)]
    middle = sorted([gap / count for gap, count in gaps])[len(gaps) // 2]
    return sorted([abs(gap - count * middle) / sqrt(count) for gap, count in gaps])[len(gaps) // 2] / middle
