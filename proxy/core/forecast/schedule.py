"""When a stream generates its samples: what a spec says, what its robot tells, or what was seen of it.

A stream is periodic unless it shows otherwise: bursts by pauses far longer than the gaps within, randomness by
generation times that no period explains. Of a random stream no more is known than its rate.
"""

import math
from collections import deque
from collections.abc import Callable

from proxy.core.forecast.bursts import Bursts, bursts_in, told_bursts
from proxy.core.forecast.gaps import RUN, spread
from proxy.core.forecast.patterns import Memoryless, Pattern, Periodic, Span
from proxy.core.forecast.rhythm import LEAST_PERIOD, Numbered, Rhythm
from proxy.core.forecast.tracker import Tracker
from proxy.core.forecast.written import written
from utility_specs.schedules import ScheduleRule

MEMORY = 48
"""Generation times looked back on for bursts and rates; the rhythm has a shorter memory."""
STALE = 10.0
"""A stream of one sample may be silent for so long [s] before it is over."""
PERIODS = 10.0
"""Other streams are over after so many of their periods,"""
PAUSES = 3.0
"""and not before so many times the longest pause they lately made."""
FADE = 0.97
"""Pauses are forgotten: at each sample the longest shrinks by this."""
LOOSE, STAY = 0.3, 0.05
"""Jitter of more than this part of the period is no rhythm; what a stream was, it stays for a little longer."""
SURE = 12
"""So many samples have no rhythm by chance; without numbers, they have none by chance with jitter of less than"""
TIGHT = 0.06
"""this part of the period."""
RANDOM = 0.45
"""Samples come at random whose gaps deviate by more than this part of them."""
SELDOM = 6
"""That is looked at every so many samples: it takes as long as all else together."""
BACK = 3
"""So many samples in a row before the last one mean that the clock was set back."""


class Schedule:
    """The generation times of one stream, seen through (count, time) pairs."""

    def __init__(self) -> None:
        self._rule: ScheduleRule | None = None
        self._failed: Callable[[], None] = _nothing
        self._tracker = Tracker()
        self._past: deque[Numbered] = deque(maxlen=MEMORY)
        self._first: Numbered | None = None
        self._pattern: Pattern | None = None
        self.patience = STALE
        """The stream is over when it is silent for longer than this [s]."""
        self._told = ("", 0.0)
        self._longest = 0.0
        self._pause = 0.0
        self._back = 0
        self._pauses = 0
        """So many of the last gaps in a row were pauses."""
        self._resumed = -MEMORY
        self._seen = 0
        self._bursts: Bursts | None = None
        self._joined = 0
        self._spread = 0.0
        self._judged = -MEMORY
        self._periodic = True
        self._numbered = True
        self._follows = False

    @property
    def period(self) -> float:
        """Mean time between samples [s]; 0.0 while fewer than two generation times are known."""
        return 0.0 if self._pattern is None else self._pattern.period

    @property
    def jitter(self) -> float:
        """Standard deviation of a generation time from what is expected [s]; 0.0 while not known."""
        return 0.0 if self._pattern is None else self._pattern.jitter

    def unsure(self, t: float) -> float:
        """Standard deviation of a generation time at about `t` from what is expected [s]; 0.0 while not known."""
        return self.jitter if self.rhythm is None else self.rhythm.unsure(t)

    @property
    def kind(self) -> str:
        """How the stream generates, in a word for other robots; empty while not known."""
        return "" if self._pattern is None else self._pattern.kind

    @property
    def rhythm(self) -> Rhythm | None:
        """That of a periodic stream; None where it has none, or is not known."""
        return self._pattern.rhythm if isinstance(self._pattern, Periodic) else None

    @property
    def last(self) -> float | None:
        """The last generation time seen [s]."""
        return self._past[-1][1] if self._past else None

    def over(self, now: float) -> bool:
        """Whether no more samples are to be expected, as the stream is silent for too long by its own measure."""
        return not self._past or now - self._past[-1][1] >= self.patience

    def obey(self, rule: ScheduleRule | None, failed: Callable[[], None]) -> None:
        """Go by a rule of a spec, or by what is seen; `failed` is called when a function of the rule fails."""
        self._failed = failed
        if rule != self._rule:
            self._rule = rule
            self._renew()

    def observe(self, count: int | None, t_gen: float, told: Rhythm | None = None) -> None:
        """Take in that sample number `count` was generated at `t_gen`; None: some may have been lost before it.

        Older news is ignored. A rhythm that the stream's robot `told` holds: it sees every sample.
        """
        before, last = self._past[-1] if self._past else (0, -math.inf)
        if count is not None and count <= before:
            return
        if t_gen <= last:
            if told is not None:
                self._past = deque([p for p in self._past if p[1] < t_gen], maxlen=MEMORY)
            elif t_gen == last or not self._goes_back(count, t_gen):
                return
            before, last = self._past[-1] if self._past else (0, -math.inf)
        self._count_by(numbers=count is not None)
        self._follows = told is not None
        number = before + 1 if count is None else count
        gap = t_gen - last
        paused = bool(self._past) and gap >= self._silence(self._pause)
        self._pauses = self._pauses + 1 if paused else 0
        if paused:
            self._resumed = self._seen
        if told is not None:
            self._tracker.follow(told)
        elif paused:
            self._resume(count, (number, t_gen))
        elif count is None:
            self._tracker.hear(t_gen)
        else:
            self._tracker.observe(count, t_gen)
        if self._past and self._resumed != self._seen:
            self._longest = max(gap, FADE * self._longest)
        self._first = self._first or (number, t_gen)
        self._past.append((number, t_gen))
        self._back = 0
        self._seen += 1
        self._renew()

    def assume(self, period: float, kind: str = "") -> bool:
        """Use what the stream's robot tells: it sees every sample, we perhaps a few; return whether it is news."""
        if (kind, period) == self._told or not LEAST_PERIOD <= period < math.inf:
            return False
        self._told = kind, period
        self._tracker.tell(period)
        self._renew()
        return True

    def forecast(self, after: float, until: float, most: int, now: float | None = None) -> list[float]:
        """Generation times expected in (after, until], at most `most` of them, in order, as things are at `now`."""
        pattern = self._pattern
        if pattern is None or most <= 0 or until <= after:
            return []
        return pattern.expect(Span(after if now is None else now, after, until, most))

    def prospect(self) -> tuple[float, float, float]:
        """Return when the last sample came, how long its patience is, and about when the next one comes [s].

        The first one is -∞ and the last one ∞ while they are not known.
        """
        last = self._past[-1][1] if self._past else -math.inf
        return last, self.patience, last + self.period if self._pattern else math.inf

    def _goes_back(self, count: int | None, t_gen: float) -> bool:
        """Forget what stands in the way of a sample that comes before the last one; return whether it is to count.

        If it is where it was due, the last one's time was wrong. If that goes on, the clock was set back.
        """
        self._back += 1
        if len(self._past) > 1 and t_gen > self._past[-2][1] and self._tracker.withdraw(count, t_gen):
            self._past.pop()
        elif self._back >= BACK:
            self._past.clear()
            self._tracker, self._longest, self._first = Tracker(), 0.0, None
        else:
            return False
        return True

    def _count_by(self, *, numbers: bool) -> None:
        """Samples come with numbers from now on, or without: what was numbered otherwise cannot be compared."""
        if self._past and self._numbered != numbers:
            self._tracker.begin([self._past[-1]])
        self._numbered = numbers

    def _resume(self, count: int | None, sample: Numbered) -> None:
        """Take in a sample after a pause. Pauses in a row are the gaps of another rate, a few gaps before one of none.

        So a stream that begins with samples close together, or ends with seldom ones, is not over before each of them.
        """
        few = self._seen <= RUN and self._tracker.rhythm is not None
        if not few and self._pauses < RUN:
            self._tracker.resume(count, sample[1])
            return
        self._past = deque([] if few else list(self._past)[-RUN:], maxlen=MEMORY)
        self._tracker.begin([*self._past, sample], known=count is not None)

    def _renew(self) -> None:
        """Something was noted: see what the stream's pattern is now, and how long it may be silent."""
        if not (self._past and self._first):
            return
        followed = self._tracker.rhythm if self._follows else None
        self._pattern = Periodic(followed) if followed else self._recognise(self._first, self._past[-1][1])
        self._pause = self._pattern.pause if self._pattern else 0.0
        silence = max(self._silence(self._pause), PERIODS * self.period)
        self.patience = silence if self._pattern else STALE

    def _silence(self, pause: float) -> float:
        rhythm = self._tracker.rhythm
        period = rhythm.period if rhythm else STALE / PERIODS
        return max(PERIODS * period, PAUSES * max(self._longest, pause))

    def _recognise(self, first: Numbered, last: float) -> Pattern | None:
        rhythm = self._tracker.rhythm
        if self._rule is not None:
            past = [*([first] if first != self._past[0] else []), *self._past]
            return written(self._rule, past, rhythm.period if rhythm else 0.0, self._failed)
        kind, period = self._told
        told = told_bursts(kind.split(), period, last) if kind.startswith("bursts") else None
        if kind == "poisson":
            return Memoryless(period)
        if rhythm is None:
            return told
        pauses = self._longest > RUN * rhythm.period or self._seen - self._resumed < MEMORY
        if pauses and kind != "periodic":
            self._bursts = self._bursts_in(first, last)
            if self._bursts is not None:
                return self._bursts
        if told is not None:
            return told
        self._periodic = kind == "periodic" or self._has_rhythm(rhythm)
        return Periodic(rhythm) if self._periodic else Memoryless(self._mean_interval())

    def _bursts_in(self, first: Numbered, last: float) -> Bursts | None:
        """Return the bursts of the past; where one goes on, those known are not looked for again."""
        known, self._joined = self._joined, self._seen
        joined = self._bursts.joined(last) if self._bursts is not None and known == self._seen - 1 else None
        return joined or bursts_in(self._past, whole=self._past[0] == first)

    def _has_rhythm(self, rhythm: Rhythm) -> bool:
        """Whether the rhythm explains what was seen: a few samples, or any without numbers, always seem to have one."""
        if len(self._past) <= RUN + 1:
            return True
        if rhythm.looseness > LOOSE + (STAY if self._periodic else -STAY):
            return False
        chance = rhythm.known < SURE if self._numbered else rhythm.looseness > TIGHT
        if not chance:
            return True
        if self._seen >= self._judged + SELDOM or self._seen < SURE:
            self._spread, self._judged = spread(self._past), self._seen
        return self._spread < RANDOM + (STAY if self._periodic else -STAY)

    def _mean_interval(self) -> float:
        (count, first), (number, last) = self._past[0], self._past[-1]
        return (last - first) / (number - count)


def _nothing() -> None:
    """Nobody counts failures."""
