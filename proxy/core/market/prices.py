"""What a unit of each limit costs, and how each stream stands at that price.

At its *price* (`planner/steady.py`) all streams together use a limit up and no more. A stream whose messages are small
is decided by the price alone: what is lost by rounding is less than a message. It is *undisputed* when even the last
of its samples a second earns its price, so that all are sent. It is *priced* when that holds for some: it sends at the
interval that pays best. It is *hopeless* when even its first sample earns far less. All others are *contested*: where
a window holds few messages, which of them go together only the tree can say.

With 250 streams of 0.1 to 4 kB under 2 Mbit/s one decider reached 99 % of the bound at 0.4 ms a sample; 76 % at 2 ms
when all of them went to the tree.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple, Self

import numpy as np
import numpy.typing as npt

from planner import Aggregation
from planner.received import integrals
from planner.steady import INTERVALS, Steady, clearing_prices
from planner.utility.base import told_apart
from proxy.core.model.limits import Limit
from proxy.core.view.stream import Stream

SMALL = 0.05
"""A message is small that takes no more than this part of every limit. With streams of equal messages, five to a
window, booked as load teams reached 92.5 % of the bound instead of 99.4: room was kept for whole messages."""
NEW = 4.0
"""The samples of a new stream are undisputed only if they earn so many times their price: nobody knows its rate yet."""
OFFERED = 0.95
"""What varies needs the rest of a limit: so 250 small streams reached 99.4 % of the bound, without a rest 99.3, and
their decisions took a sixth more time."""
SMALL_PART = 0.3
"""A stream is hopeless when its first sample earns no more than this part of the price."""
STAY = 1.25
"""What a stream was it stays until it is beyond the bound by this factor."""
DEVIATIONS = 2.0
"""The reserve is so many standard deviations above the mean: with three, four robots with cameras sent 4 % fewer bytes;
with one, 2 % more, and three times as many windows of eight robots were over the limit."""
SURELY = 3.0
"""There is room for all where there is with so many standard deviations."""
LEAST_SPREAD = 0.25
"""In both the count of a periodic stream in a window varies by at least this (variance): by one or none."""
RHYTHM = 3
"""Of a stream that generated fewer samples nobody knows how far apart they are."""
KNOWN = 8
"""Of a stream that generated fewer samples nobody can say how often it does."""
PACE = 0.25
"""Streams are weighed anew this often [s]..."""
EACH = 1e-3
"""... where many streams compete only after so long for each of them [s]."""
MOST_SCALE = 1e100
"""What is worth more counts as this, so that all sums are finite."""

Amounts = tuple[float, ...]


class Standing(Enum):
    """How a stream, or a sample, stands."""

    UNDISPUTED = "undisputed"
    PRICED = "priced"
    CONTESTED = "contested"
    HOPELESS = "hopeless"


@dataclass(frozen=True, slots=True)
class Weighed:
    """How a stream stands whose samples are worth `scale`.

    It generates every `interval`, and is expected to send every `apart` [s]; without end when nothing of it pays.
    """

    standing: Standing
    scale: float
    interval: float
    apart: float


UNKNOWN = Weighed(Standing.CONTESTED, 0.0, 0.0, 0.0)


class Row(NamedTuple):
    """A stream as it is weighed: its mean `interval`, the `age` of its samples at receipt [s], what a sample uses.

    Of each limit it uses the mean and, where sizes vary, the deviation. `scale` counts all receivers.
    """

    stream: Stream
    interval: float
    age: float
    scale: float
    use: Amounts
    deviation: Amounts

    def small(self, limits: Sequence[Limit]) -> bool:
        """Whether its messages are small by all limits."""
        return all(u + d <= SMALL * c.limit for u, d, c in zip(self.use, self.deviation, limits, strict=True))


@dataclass(frozen=True, slots=True, eq=False)
class Market:
    """What a unit of each limit costs, and whether there is room for all; a new stream is weighed by the last one."""

    limits: tuple[Limit, ...]
    prices: npt.NDArray[np.float64]
    fits: bool

    @classmethod
    def of(cls, rows: Sequence[Row], limits: tuple[Limit, ...]) -> tuple[Self, Steady]:
        """Return the market of all that competes, and what each of these streams earns."""
        steady = _steady(rows)
        prices = clearing_prices(steady, OFFERED * np.array([c.limit / c.window for c in limits]))
        most = reserve(rows, [row.interval for row in rows], limits, SURELY)
        return cls(limits, prices, all(a <= c.limit for a, c in zip(most, limits, strict=True))), steady

    def weigh(self, rows: Sequence[Row], steady: Steady, before: Sequence[Weighed]) -> list[Weighed]:
        """Weigh streams that earn so much; how each stood `before` is what it stays where it is close."""
        cost = steady.use @ self.prices
        marginal, _ = steady.marginal()
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            last, first = (np.where(cost > 0.0, marginal[:, at] / cost, math.inf) for at in (0, -1))
        net = steady.value - steady.rate * cost[:, None]
        apart = np.where(net.max(axis=1) > 0.0, steady.apart[np.arange(len(rows)), net.argmax(axis=1)], math.inf)
        return [
            Weighed(
                self._standing(row, known.standing, float(last[at]), float(first[at])),
                row.stream.newest.scale,
                row.interval,
                float(apart[at]),
            )
            for at, (row, known) in enumerate(zip(rows, before, strict=True))
        ]

    def weigh_new(self, row: Row) -> Weighed:
        """Weigh a stream that was not among those that make the prices."""
        return self.weigh([row], _steady([row]), [UNKNOWN])[0]

    def _standing(self, row: Row, before: Standing, last: float, first: float) -> Standing:
        """Return how a stream stands whose last and first sample a second earn so many times their price."""
        kind, new, small = row.stream.information_type, row.stream.generated < KNOWN, row.small(self.limits)
        if self.fits and not new:
            return Standing.UNDISPUTED
        if not isinstance(kind.aggregation, Aggregation):
            return Standing.CONTESTED
        if small and last >= (NEW if new else 1.0 / STAY if before is Standing.UNDISPUTED else 1.0):
            return Standing.UNDISPUTED
        if row.stream.generated < RHYTHM or kind.guarantee.rate > 0.0:
            return Standing.CONTESTED
        if first <= SMALL_PART * (STAY if before is Standing.HOPELESS else 1.0):
            return Standing.HOPELESS
        return Standing.PRICED if small and kind.markovian else Standing.CONTESTED


def reserve(
    rows: Sequence[Row], apart: Sequence[float], limits: Sequence[Limit], deviations: float = DEVIATIONS
) -> Amounts:
    """Return what streams that send so far apart [s] use of each limit in a window, with few exceptions."""
    booked = []
    for k, limit in enumerate(limits):
        mean = variance = 0.0
        for row, interval in zip(rows, apart, strict=True):
            count = limit.window / interval
            mean += count * row.use[k]
            variance += variance_of(row.stream, count, row.use[k], row.deviation[k])
        booked.append(mean + deviations * math.sqrt(variance))
    return tuple(booked)


def variance_of(stream: Stream, count: float, use: float, deviation: float) -> float:
    """Return the variance of what a stream uses in a window: so many samples in the mean, each of such a use."""
    return _spread(stream, count) * use**2 + count * deviation**2


def interval_of(now: float, stream: Stream, window: float, most: float = 2.0) -> float:
    """Return the mean time between samples [s].

    A new stream generates in a window at most so many times as many as so far, and no faster than it did with two more.
    """
    if rate_known(now, stream, window):
        return stream.period
    return max(stream.period, window / (most * max(stream.generated, 1)), (now - stream.began) / (stream.generated + 2))


def rate_known(now: float, stream: Stream, window: float) -> bool:
    """Whether it is known how often a stream generates: from several samples, over a window [s]."""
    return stream.generated >= KNOWN and now - stream.began >= window


def _spread(stream: Stream, count: float) -> float:
    """Return the variance of how many samples a stream generates in a window, `count` in the mean."""
    kind = stream.schedule.kind
    if kind.startswith("periodic"):
        part = count - math.floor(count)
        return max(part * (1.0 - part), LEAST_SPREAD)
    return count + count * count if kind.startswith("bursts") else count


def _steady(rows: Sequence[Row]) -> Steady:
    """Return what each stream earns by the interval between its sends."""
    kinds = [row.stream.information_type for row in rows]
    each = [kind.utility_of(row.stream.newest.features) for kind, row in zip(kinds, rows, strict=True)]
    utilities, which = told_apart(each)
    apart = np.array([row.interval for row in rows])[:, None] * INTERVALS
    begin = np.broadcast_to(np.array([row.age for row in rows])[:, None], apart.shape)
    many = np.repeat(which, apart.shape[1])
    area = integrals(utilities, many, begin.ravel(), (begin + apart).ravel()).reshape(apart.shape)
    area *= np.array([min(row.scale, MOST_SCALE) for row in rows])[:, None]
    for at, kind in enumerate(kinds):
        if kind.aggregation in (Aggregation.SUM, Aggregation.ONCE):
            area[at] = area[at, -1]
    return Steady(np.arange(len(rows)), area / apart, 1.0 / apart, np.array([row.use for row in rows]))
