"""When a stream generates its samples."""

import math

from proxy.core.forecast.patterns import Pattern, Periodic, Span
from proxy.core.forecast.recognition import History, Recognition
from proxy.core.forecast.rhythm import Numbered, Rhythm
from proxy.core.forecast.tracker import Tracker
from proxy.core.forecast.tuning import TUNING
from utility_specs.schedules import ScheduleRule
from utility_specs.specs import Failures


class Schedule:
    """The generation times of one stream, seen through (count, time) pairs."""

    def __init__(self) -> None:
        self.timeout = TUNING.lone_timeout
        """The stream is over when it is silent for longer than this [s]."""
        self._pause = TUNING.lone_timeout
        """From how long on a gap is a pause [s]: less than that where samples come fast."""
        self.resumed = -math.inf
        """When it began again after a pause [s]."""
        self.period = 0.0
        """Mean time between samples [s]; 0.0 while fewer than two generation times are known."""
        self.jitter = 0.0
        """Standard deviation of a generation time from what is expected [s]; 0.0 while not known."""
        self.kind = ""
        """How the stream generates, in a word for other robots; empty while not known."""
        self._history = History()
        self._tracker = Tracker()
        self._recognition = Recognition()
        self._pattern: Pattern | None = None
        self._back = 0
        """So many samples in a row came before the last one."""
        self._reported = False
        """Whether its robot reported the rhythm of the last sample."""

    def uncertainty(self, t: float) -> float:
        """Standard deviation of a generation time at about `t` from what is expected [s]; 0.0 while not known."""
        return self.jitter if self.rhythm is None else self.rhythm.uncertainty(t)

    @property
    def rhythm(self) -> Rhythm | None:
        """That of a periodic stream; None where it has none, or is not known."""
        return self._pattern.rhythm if isinstance(self._pattern, Periodic) else None

    @property
    def last(self) -> float | None:
        """The last generation time seen [s]."""
        return self._history.newest[1] if self._history.past else None

    def over(self, now: float) -> bool:
        """Whether no more samples are to be expected, as the stream is silent for too long by its own measure."""
        return now >= self.over_at

    @property
    def over_at(self) -> float:
        """From when on no more samples are to be expected, if none comes until then [s]."""
        return self._history.newest[1] + self.timeout

    def set_rule(self, rule: ScheduleRule | None, failures: Failures) -> None:
        """Go by a rule of a spec, or by what is seen; `failures` counts those of a function of the rule."""
        if self._recognition.set_rule(rule, failures):
            self._renew()

    def observe(self, count: int, t_gen: float, reported: Rhythm | None = None) -> None:
        """Take in that sample `count` was generated at `t_gen` [s], unless it is old; a `reported` rhythm holds."""
        history = self._history
        if count <= history.newest[0]:
            return
        if t_gen <= history.newest[1]:
            if reported is not None:
                history.forget_since(t_gen)
            elif t_gen == history.newest[1] or not self._goes_back():
                return
        sample = count, t_gen
        paused = t_gen - history.newest[1] >= self._pause and bool(history.past)
        if paused and self.over(t_gen):
            self.resumed = t_gen
        history.note_gap(paused=paused)
        if reported is not None:
            self._tracker.follow(reported)
        elif paused:
            self._resume(sample)
        else:
            self._tracker.observe(count, t_gen)
        history.note(sample, paused=paused)
        self._back, self._reported = 0, reported is not None
        self._renew()

    def assume(self, period: float, kind: str = "") -> bool:
        """Use what the stream's robot reports: it sees every sample, we perhaps a few; return whether it is news."""
        if not TUNING.least_period <= period < math.inf or not self._recognition.report(kind, period):
            return False
        self._tracker.report(period)
        self._renew()
        return True

    def forecast(self, after: float, until: float, most: int, now: float | None = None) -> list[float]:
        """Generation times expected in (after, until], at most `most` of them, in order, as things are at `now`."""
        if self._pattern is None or most <= 0 or until <= after:
            return []
        return self._pattern.expect(Span(after if now is None else now, after, until, most))

    def ahead(self, now: float, after: float, until: float, most: int, at_last: float) -> list[float]:
        """Return the same as things are now; where that is never the first one until `at_last` [s], if any."""
        if self._pattern is None or until <= after:
            return self.forecast(after, at_last, 1, now)
        return self._pattern.ahead(Span(now, after, until, most), at_last)

    def prospect(self) -> tuple[float, float]:
        """Return from when on the stream is over (-∞: nothing came), and when about a sample comes next (or ∞) [s]."""
        return self.over_at, self._history.newest[1] + self.period if self._pattern else math.inf

    def _goes_back(self) -> bool:
        """Begin a new past at a sample before the last one, where several were; return whether it counts so."""
        self._back += 1
        if self._back < TUNING.run:
            return False
        self._history.restart()
        self._tracker = Tracker()
        return True

    def _resume(self, sample: Numbered) -> None:
        """Take in a sample after a pause. Pauses in a row, a few gaps after no other, are the gaps of another rate."""
        few = self._history.seen <= TUNING.run and self._tracker.rhythm is not None
        if not few and self._history.pauses < TUNING.run:
            self._tracker.resume(*sample)
            return
        self._history.keep(0 if few else TUNING.run)
        self._tracker.begin([*self._history.past, sample])

    def _renew(self) -> None:
        """Something was noted: see what the stream's pattern is now, and how long it may be silent."""
        if not self._history.past:
            return
        rhythm = self._tracker.rhythm
        told = Periodic(rhythm) if rhythm is not None and self._reported else None
        self._pattern = pattern = told or self._recognition.pattern(self._history, rhythm)
        if pattern is None:
            self.period, self.jitter, self.kind, self.timeout = 0.0, 0.0, "", TUNING.lone_timeout
            self._pause = self.timeout
            return
        self.period, self.jitter, self.kind = pattern.period, pattern.jitter, pattern.kind
        period = max(self.period, rhythm.period if rhythm else 0.0)
        gap = max(self._history.longest_gap, pattern.pause)
        least = TUNING.least_timeout if period else TUNING.lone_timeout
        gaps = TUNING.timeout_gaps * gap
        self.timeout = max(least, TUNING.timeout_periods * period, gaps)
        self._pause = min(self.timeout, max(TUNING.pause_periods * period, gaps))
