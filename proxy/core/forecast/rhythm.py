"""A rhythm: period, phase and jitter of numbered generation times, by a robust straight line.

The slope is the median over pairs half of the memory apart (a kin of Theil and Sen's); least squares over the times
that are near that line give the estimate.
"""

from collections.abc import Sequence
from itertools import pairwise
from math import sqrt
from typing import NamedTuple

from proxy.core.forecast.tuning import TUNING

Numbered = tuple[int, float]
"""The number of a sample and when it was generated [s]."""


class Rhythm(NamedTuple):
    """Sample `number` was due at `origin` [s], others every `period` [s]; `known` samples tell their `jitter`."""

    period: float
    origin: float
    number: int
    jitter: float
    known: int
    wanders: bool = False
    """Whether deviations add up, so that the last time alone tells the next."""

    @property
    def looseness(self) -> float:
        """The jitter as a part of the period."""
        return self.jitter / self.period

    def due(self, number: int) -> float:
        """When a sample was or is due [s]."""
        return self.origin + (number - self.number) * self.period

    def uncertainty(self, t: float) -> float:
        """The standard deviation of the time of a sample that is due at about `t`; it grows with the time since [s].

        Two samples are always on a line: four robots that began together lost 33 small samples, as two sent a frame at
        one moment, and lose none.
        """
        known = max(self.known, 2)
        jitter = self.jitter if known >= TUNING.few else max(self.jitter, TUNING.least_jitter * self.period)
        along = max(0.0, t - self.origin) / self.period + 0.5 * (known - 1)
        return jitter * sqrt(1.0 + 1.0 / known + 12.0 * along * along / (known * (known * known - 1.0)))

    def nudged(self, number: int, t: float, step: float = 1.0) -> "Rhythm":
        """Return the rhythm with one more sample, weighed as least squares over those `known`, `step` apart, would."""
        due, known = self.due(number), self.known
        weight = 1.0 / (known * (known + 1))
        origin = t if self.wanders else due + (4 * known - 2) * weight * (t - due)
        period = self.period + 6.0 * weight * (t - due) / step
        return Rhythm(period, origin, number, self.jitter, known, self.wanders)


def fit(points: Sequence[Numbered], period: float = 0.0) -> Rhythm | None:
    """Return the rhythm of generation times, of which numbers and times rise; None for fewer than two, or none apart.

    A given `period` [s] holds as it is: then one time is enough.
    """
    if not points or (len(points) < 2 and not period):
        return None
    number, last = points[-1]
    x = [n - number for n, _ in points]
    y = [t - last for _, t in points]
    slope = period or _slope(x, y)
    if slope < TUNING.least_period:
        return None
    kept = _near(x, y, slope)
    if len(kept) > 2 and not period:
        slope = max(TUNING.least_period, max(0.0, least_squares(kept)) or slope)
    rest = [b - slope * a for a, b in kept]
    start = sum(rest) / len(rest)
    square = sum([(e - start) ** 2 for e in rest]) / max(len(rest) - 2, 1)
    steps = sum([(b - a) ** 2 for a, b in pairwise(rest)]) / max(len(rest) - 1, 1)
    wanders = (
        len(rest) > 4 and square > max(TUNING.wandering, 0.5 + len(rest) / TUNING.walk) * steps and kept[-1][0] == 0
    )
    if wanders:
        start, square = rest[-1], steps
    return Rhythm(slope, last + start, number, sqrt(square), len(points), wanders)


def _slope(x: list[int], y: list[float]) -> float:
    half = max(1, len(x) // 2)
    slopes = sorted([(y[i + half] - y[i]) / (x[i + half] - x[i]) for i in range(len(x) - half)])
    return slopes[len(slopes) // 2]


def _near(x: list[int], y: list[float], slope: float) -> list[Numbered]:
    """Return the points that are not far from the line of this slope; at least half of them."""
    rest = [b - slope * a for a, b in zip(x, y, strict=True)]
    middle = sorted(rest)[len(rest) // 2]
    off = [abs(e - middle) for e in rest]
    most = max(TUNING.far * sorted(off)[len(off) // 2], TUNING.exact * slope)
    return [(a, b) for a, b, e in zip(x, y, off, strict=True) if e <= most]


def least_squares(points: Sequence[Numbered]) -> float:
    """Return the slope of the best line through points; 0.0 where they have one place."""
    count = len(points)
    sum_x = sum([a for a, _ in points])
    sum_y = sum([b for _, b in points])
    over = sum([a * b for a, b in points]) - sum_x * sum_y / count
    under = sum([a * a for a, _ in points]) - sum_x * sum_x / count
    return over / under if under > 0.0 else 0.0
