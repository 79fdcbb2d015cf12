"""What a unit of each limit costs, and how each stream stands at that price.

At its *price* (`planner/steady.py`) all streams together use a limit up. Where messages are small a stream is
*undisputed* when even the last of its samples a second earns that, *priced* when some do: it sends at the interval that
pays best. It is *hopeless* when even the first earns far less. All others are *contested*: the tree decides. With 250
small streams under 2 Mbit/s one decider reached 99 % of the bound so at 0.4 ms a sample; with the tree 76 at 2.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from planner import Aggregation
from planner.received import integrals
from planner.steady import INTERVALS, Steady, clearing_prices
from planner.utility import Floats
from planner.utility.base import told_apart
from proxy.core.market.standing import Amounts, Row, Standing, Weighed, load_of, reserve, variance_of
from proxy.core.market.tuning import TUNING
from proxy.core.model.limits import Limit, longest_window
from proxy.core.model.tuning import TUNING as MODEL
from proxy.core.view.stream import excess


@dataclass(frozen=True, slots=True, eq=False)
class Market:
    """What a unit of each limit costs, and whether there is room for all; a new stream is weighed by the last one."""

    limits: tuple[Limit, ...]
    prices: Amounts
    fits: bool
    small: float
    """Messages that take no more than this part of every limit are decided by their price alone."""

    @classmethod
    def of(
        cls, rows: Sequence[Row], limits: tuple[Limit, ...], horizon: int, offered: Amounts = ()
    ) -> tuple[Self, Steady]:
        """Return the market of all that competes, and what each stream earns; plans look at `horizon` messages.

        So much of each limit is `offered` in a second; where nothing is said of that it is the limit in its window.
        """
        steady = _steady(rows)
        rates = np.array(offered or [c.limit / c.window for c in limits])
        prices = clearing_prices(steady, TUNING.offered * rates)
        if prices.any():
            parts = 1.0 - TUNING.offered_deviations * _varying(rows, steady, prices, limits)
            if (parts < TUNING.offered).any():
                prices = clearing_prices(steady, np.clip(parts, TUNING.least_offered, TUNING.offered) * rates)
        most = reserve(rows, [row.interval for row in rows], limits, TUNING.sure_deviations)
        fits, small = all(a <= c.limit for a, c in zip(most, limits, strict=True)), _small(rows, limits, horizon)
        return cls(limits, tuple(prices.tolist()), fits, small), steady

    def weigh(self, rows: Sequence[Row], steady: Steady) -> list[Weighed]:
        """Weigh streams that earn so much."""
        cost = steady.use @ np.array(self.prices)
        marginal, _ = steady.marginal
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            last, first = (np.where(cost > 0.0, marginal[:, at] / cost, math.inf) for at in (0, -1))
        each = (of.tolist() for of in (last, first, _apart(steady, cost), cost, marginal[:, 0], marginal[:, -1]))
        weighed = [
            Weighed(
                self._standing(row, of_last, of_first),
                row.stream.newest.scale,
                row.interval,
                best,
                price,
                least,
                most,
                row.relief,
            )
            for row, of_last, of_first, best, price, least, most in zip(rows, *each, strict=True)
        ]
        if not self.fits and not any(self.prices):
            return self._without_surplus(rows, steady, weighed)
        return self._with_the_rest(rows, steady, weighed)

    def _without_surplus(self, rows: Sequence[Row], steady: Steady, weighed: list[Weighed]) -> list[Weighed]:
        """Let streams of which every sample is not needed send less often, where nothing has a price and not all fits.

        They share what the others leave of the limits that they use, as far as that costs them nothing. Of two robots
        with status of 11 Hz, each of which does for 20 s, and poses of 2 Hz a fourth of the poses found no room.
        """
        least = (1.0 - TUNING.needless) * steady.value.max(axis=1, keepdims=True)
        longest = (INTERVALS * (steady.value >= least)).max(axis=1).tolist()
        idle = {
            at: times
            for at, (row, w, times) in enumerate(zip(rows, weighed, longest, strict=True))
            if w.standing is Standing.UNDISPUTED
            and times > 1.0
            and row.stream.information_type.markovian
            and row.stream.generated >= TUNING.rhythm_samples
        }
        if not idle:
            return weighed
        sharing = [rows[at] for at in idle]
        asked = reserve(sharing, [row.interval for row in sharing], self.limits, deviations=0.0)
        used = reserve(
            *load_of(each for at, each in enumerate(zip(rows, weighed, strict=True)) if at not in idle), self.limits
        )
        often = [
            each / max(TUNING.offered * c.limit - amount, TUNING.smallest * c.limit)
            for each, amount, c in zip(asked, used, self.limits, strict=True)
        ]
        found = list(weighed)
        for at, times in idle.items():
            tight = max([part for part, use in zip(often, rows[at].use, strict=True) if use > 0.0], default=0.0)
            if tight > 1.0:
                apart = min(math.ceil(tight), times) * weighed[at].interval
                found[at] = weighed[at]._replace(standing=Standing.PRICED, apart=apart)
        return found

    def _with_the_rest(self, rows: Sequence[Row], steady: Steady, weighed: list[Weighed]) -> list[Weighed]:
        """Let priced streams send more often, where as many whole contested messages fit beside that as before.

        Prices know nothing of whole messages: of three robots with cameras of 25 kB and odometry of 50 Hz on 2 Mbit/s
        half of the odometry was left out, though a quarter of the limit was not used.
        """
        if not {Standing.PRICED, Standing.CONTESTED} <= {w.standing for w in weighed}:
            return weighed
        contested = [row for row, w in zip(rows, weighed, strict=True) if w.standing is Standing.CONTESTED]
        mean = np.array([row.use for row in contested]).mean(axis=0)
        smaller = mean - TUNING.smaller_deviations * np.array([row.deviation for row in contested]).mean(axis=0)
        before = self._whole(zip(rows, weighed, strict=True), smaller.tolist(), deviations=0.0)
        cost = np.array([w.cost for w in weighed])
        for part in TUNING.cheaper:
            more = [
                w._replace(apart=apart) if w.standing is Standing.PRICED else w
                for w, apart in zip(weighed, _apart(steady, part * cost).tolist(), strict=True)
            ]
            after = self._whole(zip(rows, more, strict=True), mean.tolist(), TUNING.reserve_deviations)
            if all(fit >= max(least, 0.0) for fit, least in zip(after, before, strict=True)):
                return more
        return weighed

    def _whole(self, weighed: Iterable[tuple[Row, Weighed]], use: Sequence[float], deviations: float) -> list[float]:
        """Return how many whole messages with this use of each limit fit beside streams that vary by so much.

        −∞ where these fill the limit.
        """
        found, booked = [], reserve(*load_of(weighed), self.limits, deviations)
        for limit, amount, each in zip(self.limits, booked, use, strict=True):
            fit = (limit.limit - amount) / each if each > 0.0 else 0.0
            fit = math.floor(fit) if fit >= 1.0 else fit  # what does not fit counts in a longer window, not as a whole
            found.append(fit if amount <= TUNING.booked * limit.limit else -math.inf)
        return found

    def weigh_new(self, row: Row) -> Weighed:
        """Weigh a stream that was not among those that make the prices."""
        return self.weigh([row], _steady([row]))[0]

    def _standing(self, row: Row, last: float, first: float) -> Standing:
        """Return how a stream stands whose last and first sample a second earn so many times their price."""
        kind, new, small = (
            row.stream.information_type,
            row.stream.generated < TUNING.rate_samples,
            row.takes_at_most(self.small, self.limits),
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


def _apart(steady: Steady, cost: Floats) -> Floats:
    """Return at which interval each stream sends whose messages cost so much [s]; ∞: never."""
    best, pays = steady.pays_best(steady.value - steady.rate * cost[:, None])
    return np.where(pays, steady.apart[np.arange(len(best)), best], math.inf)


def _small(rows: Sequence[Row], limits: Sequence[Limit], horizon: int) -> float:
    """Return up to which part of every limit messages are small: less where a plan can hold all that are larger."""
    ahead = MODEL.planned_windows * longest_window(limits)
    larger = sum([ahead / row.interval for row in rows if not row.takes_at_most(TUNING.smallest, limits)])
    return TUNING.smallest if larger <= horizon else TUNING.small


def _varying(rows: Sequence[Row], steady: Steady, prices: Floats, limits: Sequence[Limit]) -> Floats:
    """Return by what part of each limit what streams send at these prices varies by window, without large messages."""
    best, _ = steady.pays_best(steady.value - steady.rate * steady.charge(prices)[:, None])
    apart = steady.apart[np.arange(len(rows)), best].tolist()
    found = []
    for k, limit in enumerate(limits):
        most = TUNING.varying_size * limit.limit
        each = [
            variance_of(row.stream, limit.window / interval, row.use[k], row.deviation[k])
            for row, interval in zip(rows, apart, strict=True)
            if row.use[k] <= most
        ]
        found.append(math.sqrt(sum(each)) / limit.limit)
    return np.array(found)


def _steady(rows: Sequence[Row]) -> Steady:
    """Return what each stream earns by the interval between its sends: also that nothing is lost once it has sent."""
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
    lost = np.array([row.relief and row.relief * min(excess(row.stream), TUNING.most_scale) for row in rows])[:, None]
    return Steady(np.arange(len(rows)), area / apart + lost, 1.0 / apart, np.array([row.use for row in rows]))
