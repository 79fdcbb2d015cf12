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
from proxy.core.market.tuning import TUNING
from proxy.core.model.limits import Limit, use_of
from proxy.core.view.audience import Audience
from proxy.core.view.stream import Stream

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
    The room of a sample costs so much; one earns `least` where all are sent, `most` where hardly any is [utility·s].
    """

    standing: Standing
    scale: float
    interval: float
    apart: float
    cost: float = 0.0
    least: float = 0.0
    most: float = 0.0


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
        return all(u + d <= TUNING.small * c.limit for u, d, c in zip(self.use, self.deviation, limits, strict=True))

    def has_room(self, limits: Sequence[Limit]) -> bool:
        """Whether limits that are our part are as large as its messages; others have no turn now, and set no price."""
        return all(use <= c.limit for use, c in zip(self.use, limits, strict=True))


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
        prices = clearing_prices(steady, TUNING.offered * np.array([c.limit / c.window for c in limits]))
        most = reserve(rows, [row.interval for row in rows], limits, TUNING.sure_deviations)
        return cls(limits, prices, all(a <= c.limit for a, c in zip(most, limits, strict=True))), steady

    def weigh(self, rows: Sequence[Row], steady: Steady) -> list[Weighed]:
        """Weigh streams that earn so much."""
        cost = steady.use @ self.prices
        marginal, _ = steady.marginal()
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            last, first = (np.where(cost > 0.0, marginal[:, at] / cost, math.inf) for at in (0, -1))
        net = steady.value - steady.rate * cost[:, None]
        apart = np.where(net.max(axis=1) > 0.0, steady.apart[np.arange(len(rows)), net.argmax(axis=1)], math.inf)
        return [
            Weighed(
                self._standing(row, float(last[at]), float(first[at])),
                row.stream.newest.scale,
                row.interval,
                float(apart[at]),
                float(cost[at]),
                float(marginal[at, 0]),
                float(marginal[at, -1]),
            )
            for at, row in enumerate(rows)
        ]

    def weigh_new(self, row: Row) -> Weighed:
        """Weigh a stream that was not among those that make the prices."""
        return self.weigh([row], _steady([row]))[0]

    def _standing(self, row: Row, last: float, first: float) -> Standing:
        """Return how a stream stands whose last and first sample a second earn so many times their price."""
        kind, new, small = (
            row.stream.information_type,
            row.stream.generated < TUNING.rate_samples,
            row.small(self.limits),
        )
        if self.fits and not new:
            return Standing.UNDISPUTED
        if not isinstance(kind.aggregation, Aggregation):
            return Standing.CONTESTED
        if small and last >= (TUNING.new_price if new else 1.0):
            return Standing.UNDISPUTED
        if row.stream.generated < TUNING.rhythm_samples or kind.guarantee.rate > 0.0:
            return Standing.CONTESTED
        if first <= TUNING.hopeless:
            return Standing.HOPELESS
        return Standing.PRICED if small and kind.markovian else Standing.CONTESTED


def row_of(now: float, stream: Stream, audience: Audience, copies: int, limits: tuple[Limit, ...], *, own: bool) -> Row:
    """Return what there is to know of a stream whose samples go to this audience, in so many copies."""
    size = round(stream.sizes.mean)
    use = use_of(size, copies, limits, own=own)
    more = use_of(size + round(stream.sizes.deviation), copies, limits, own=own)
    return Row(
        stream,
        interval_of(now, stream, min(c.window for c in limits)),
        audience.mean if audience.share > 0.0 else audience.latency,
        stream.newest.scale * audience.share,
        use,
        tuple([m - u for m, u in zip(more, use, strict=True)]),
    )


def reserve(
    rows: Sequence[Row], apart: Sequence[float], limits: Sequence[Limit], deviations: float = TUNING.reserve_deviations
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
    return stream.generated >= TUNING.rate_samples and now - stream.began >= window


def _spread(stream: Stream, count: float) -> float:
    """Return the variance of how many samples a stream generates in a window, `count` in the mean."""
    kind = stream.schedule.kind
    if kind.startswith("periodic"):
        part = count - math.floor(count)
        return max(part * (1.0 - part), TUNING.least_variance)
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
    area *= np.array([min(row.scale, TUNING.most_scale) for row in rows])[:, None]
    for at, kind in enumerate(kinds):
        if kind.aggregation in (Aggregation.SUM, Aggregation.ONCE):
            area[at] = area[at, -1]
    return Steady(np.arange(len(rows)), area / apart, 1.0 / apart, np.array([row.use for row in rows]))
