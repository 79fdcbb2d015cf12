"""Which pattern a stream has: as a spec says, as its robot reports, or as what was seen of it shows.

A stream is periodic unless it shows bursts by long pauses, or randomness by times that no period explains.
"""

import math
from collections import deque
from collections.abc import Sequence
from itertools import pairwise
from math import sqrt

from proxy.core.forecast.patterns import Bursts, Memoryless, Pattern, Periodic, bursts_in, reported_bursts
from proxy.core.forecast.rhythm import Numbered, Rhythm
from proxy.core.forecast.tuning import TUNING
from proxy.core.forecast.written import written
from utility_specs.schedules import ScheduleRule
from utility_specs.specs import Failures


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
            self.longest_gap = max(sample[1] - self.past[-1][1], TUNING.gap_fade * self.longest_gap)
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
    (count, first), (number, last) = seen.past[0], seen.past[-1]
    return (last - first) / (number - count)


def _spread(points: Sequence[Numbered]) -> float:
    """Return the median deviation of gaps between numbered times as a part of their median: 0.7 if random."""
    gaps = [((t - s), n - m) for (m, s), (n, t) in pairwise(points)]
    middle = sorted([gap / count for gap, count in gaps])[len(gaps) // 2]
    return sorted([abs(gap - count * middle) / sqrt(count) for gap, count in gaps])[len(gaps) // 2] / middle
