"""Follows the rhythm of a stream through lost samples, outliers, restarts and changes of rate.

A sample far from where it was due is a suspect, alone an outlier. Three in a row that are off by the same are a phase
that jumped, three with a period of their own another rate; else the stream is looser than it seemed.
"""

from collections.abc import Sequence
from itertools import pairwise

from proxy.core.forecast.rhythm import Numbered, Rhythm, fit, least_squares
from proxy.core.forecast.tuning import TUNING


class Tracker:
    """The rhythm of one stream."""

    def __init__(self) -> None:
        self.rhythm: Rhythm | None = None
        self._reported = 0.0
        """A period that its robot reported, which holds while too few samples were seen [s]; 0.0: none."""
        self._line: list[Numbered] = []
        self._suspects: list[Numbered] = []
        self._since = 0

    def observe(self, count: int, t: float) -> None:
        """Take in that sample number `count` was generated at `t` [s]; both rise."""
        rhythm = self.rhythm
        if rhythm is None or abs(t - rhythm.due(count)) <= _gate(rhythm):
            self._take(count, t)
        else:
            self._doubt(rhythm, count, t)

    def resume(self, count: int, t: float) -> None:
        """Take in a sample after a pause: the period is what it was, the phase is not."""
        self._suspects.clear()
        if self.rhythm is not None:
            shift = t - self.rhythm.due(count)
            self._line = [(n, old + shift) for n, old in self._line]
            self._since = TUNING.seldom
        self._take(count, t)

    def begin(self, samples: list[Numbered]) -> None:
        """Take in these samples; what was seen before them counts no more."""
        self._suspects.clear()
        self._line = samples
        self._fit()

    def follow(self, rhythm: Rhythm) -> None:
        """Take over the rhythm that the stream's robot found; what was seen before counts no more."""
        self.rhythm = rhythm
        self._line = [(rhythm.number, rhythm.origin)]
        self._suspects.clear()

    def report(self, period: float) -> None:
        """Use a period that the stream's robot found [s]: if it differs, what was seen before it is over."""
        self._reported = period
        if self.rhythm is not None and not 1.0 / TUNING.alike < period / self.rhythm.period < TUNING.alike:
            self._line, self._suspects = self._line[-1:], []
        self._fit()

    def _take(self, number: int, t: float) -> None:
        self._suspects.clear()
        self._line.append((number, t))
        self._since += 1
        if self.rhythm is not None and self.rhythm.known >= TUNING.short_memory // 2 and self._since < TUNING.seldom:
            step = (number - self._line[0][0]) / (len(self._line) - 1)
            nudged = self.rhythm.nudged(number, t, step)
            if nudged.period >= TUNING.least_period:
                self.rhythm = nudged
                return
        self._fit()

    def _fit(self) -> None:
        self._since = 0
        del self._line[: -TUNING.memory]
        line, newest = self._line, self._line[-TUNING.short_memory :]
        if self.rhythm is not None and self.rhythm.known > TUNING.short_memory and self._fit_whole(newest):
            return
        self.rhythm = fit(newest, self._reported if len(line) < TUNING.run + 1 else 0.0)
        if len(line) > TUNING.short_memory and self.rhythm is not None and self.rhythm.looseness < TUNING.tight:
            self._fit_whole(newest)

    def _fit_whole(self, newest: Sequence[Numbered]) -> bool:
        """Let all that is remembered tell the rhythm, if that is tight and holds for the `newest`; whether it is so."""
        whole = fit(self._line)
        if whole is None or whole.wanders or whole.looseness >= TUNING.tight or not _holds(whole, newest):
            return False
        self.rhythm = whole
        return True

    def _doubt(self, rhythm: Rhythm, number: int, t: float) -> None:
        self._suspects.append((number, t))
        suspects = self._suspects[-TUNING.run :]
        if len(suspects) < TUNING.run:
            return
        off = sorted([at - rhythm.due(n) for n, at in suspects])
        if off[-1] - off[0] <= _gate(rhythm):
            self._line = [(n, at + off[1]) for n, at in self._line]
        elif _steady(suspects):
            last = self._line[-1:]
            self._line = last if _steady([*last, *suspects]) else []
        elif len(self._suspects) < TUNING.unlike:
            return
        else:
            suspects = self._suspects
        self._line += suspects
        self._suspects = []
        self._fit()


def _gate(rhythm: Rhythm) -> float:
    """How far from its time a sample of the rhythm may be [s]; if it has hardly any, at any time."""
    looseness = max(rhythm.looseness, TUNING.least_gate) if rhythm.known < TUNING.few else rhythm.looseness
    if looseness > TUNING.any_time:
        return float("inf")
    return max(TUNING.least_gate, TUNING.gate * looseness) * rhythm.period


def _holds(rhythm: Rhythm, points: Sequence[Numbered]) -> bool:
    """Whether these times, but for those far off, are about as near to the rhythm as to the best line through them."""
    most = TUNING.gate * rhythm.jitter + TUNING.exact * rhythm.period
    off = [(n - rhythm.number, e) for n, t in points if abs(e := t - rhythm.due(n)) <= most]
    if len(off) <= len(points) // 2:
        return False
    x, y = (sum(each) / len(off) for each in zip(*off, strict=True))
    slope = least_squares(off)
    own = sum([(e - y - slope * (n - x)) ** 2 for n, e in off])
    return bool(
        sum([e * e for _, e in off]) <= TUNING.better_line * own + len(off) * (TUNING.exact * rhythm.period) ** 2
    )


def _steady(points: list[Numbered]) -> bool:
    """Whether the steps between numbered times are alike."""
    steps = [(s - t) / (n - m) for (m, t), (n, s) in pairwise(points)]
    return max(steps) <= TUNING.alike * min(steps)
