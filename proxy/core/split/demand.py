"""A bid out of a robot's own streams: what they need and what it is worth."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

from proxy.core.protocol.bid import QUARTERS, UNIT, Bid, Segment, level_of
from proxy.core.protocol.tuning import TUNING as BOUNDS
from proxy.core.split.tuning import TUNING

ROUNDING = 1e-9
"""Numbers that differ by no more than this part are equal."""


@dataclass(frozen=True, slots=True)
class Demand:
    """What one stream asks for."""

    sizes: Sequence[float]
    """What recent messages used of the limit, all copies counted; a few are enough."""
    rate: float
    """Messages that it generates [1/s]."""
    value: Callable[[float], float]
    """Utility per second when so many messages per second are sent; concave."""
    variance: float = 0.0
    """Of what it uses of the limit in a window."""
    period: float = 0.0
    """Of its rhythm [s]; 0.0: it has none that is known."""


def bid_for(demands: Iterable[Demand], window: float, robots: int) -> Bid:
    """Return what streams ask for together of a limit with this window [s], among so many robots.

    Small messages ask for their mean and what they vary by, large ones for slots, and beyond for divisible room.
    """
    small, asking = _small_message(robots), _asking(demands)
    few = _small([demand for demand in asking if max(demand.sizes) <= small], window, 1.0 / max(1, robots))
    large = [s for demand in asking if max(demand.sizes) > small for s in _large(demand, window, small)]
    return tuple(sorted(few + large, key=lambda s: (-s.level, s.quarters, s.amount))[: BOUNDS.segments])


def usual_message(demands: Iterable[Demand], robots: int) -> int:
    """Return what a usual message takes of the stream whose large ones are smallest [units]; 0: none is large."""
    means = [sum(d.sizes) / len(d.sizes) for d in _asking(demands) if max(d.sizes) > _small_message(robots)]
    return _units(UNIT * min(means)) if means else 0


def _asking(demands: Iterable[Demand]) -> list[Demand]:
    return [d for d in demands if d.rate > 0.0 and d.sizes and min(d.sizes) > 0.0]


def _small_message(robots: int) -> float:
    """Return the part of a limit up to which messages are small among so many robots."""
    return min(TUNING.small_message, 0.5 / max(1, robots))


def _small(demands: Sequence[Demand], window: float, equal: float) -> list[Segment]:
    """Ask for what streams use in the mean, at several values beyond some of an `equal` part, and what they vary by."""
    levels = []
    for demand in demands:
        amount = UNIT * sum(demand.sizes) / len(demand.sizes) * demand.rate * window
        low = before = 0.0
        for share in TUNING.rate_shares if amount > TUNING.much * UNIT * equal else (1.0,):
            high = demand.value(share * demand.rate)
            levels.append((level_of((high - low) / (amount * (share - before))), amount * (share - before)))
            low, before = high, share
    joined = [Segment(_units(amount), level) for level, amount in _joined(levels, TUNING.divisible_segments)]
    spare = UNIT * TUNING.spare_deviations * math.sqrt(sum(demand.variance for demand in demands))
    if not spare:
        return joined
    usual = sum(level * amount for level, amount in levels) / sum(amount for _, amount in levels)
    return [*joined, Segment(_units(spare), max(0, round(usual) - TUNING.spare_levels))]


def _joined(rooms: Sequence[tuple[int, float]], most: int) -> list[tuple[int, float]]:
    """Put together what is worth the same, and what is worth about the same where there are too many."""
    ranked = sorted(rooms, reverse=True)
    levels = [(level, sum(amount for _, amount in same)) for level, same in groupby(ranked, key=lambda room: room[0])]
    while len(levels) > most:
        at = min(range(len(levels) - 1), key=lambda i: levels[i][0] - levels[i + 1][0])
        (high, one), (low, other) = levels[at : at + 2]
        levels[at : at + 2] = [(round((high * one + low * other) / (one + other)), one + other)]
    return levels


def _large(demand: Demand, window: float, small: float) -> list[Segment]:
    """Ask for room by what each more of it is worth: the first for a message as a whole, if it is large."""
    hull = _hull([(0.0, 0.0), *((part, demand.value(_rate(demand, part, window))) for part in _parts(demand))])
    segments: list[Segment] = []
    for (before, low), (part, high) in pairwise(hull):
        whole = part > max(demand.sizes) or (not before and part > small)
        if whole and not before:
            segments += _turns(demand, part, window)
        else:
            level = level_of((high - low) / (UNIT * (part - before)))
            segments.append(Segment(_units(UNIT * (part - before)), level, QUARTERS if whole else 0))
    return segments


def _parts(demand: Demand) -> list[float]:
    """Parts of a limit at which to look: the stream's sizes, and several times the largest, as far as that is asked."""
    sizes = sorted(demand.sizes)
    some = {
        sizes[(i + 1) * len(sizes) // TUNING.sizes - 1]
        for i in range(TUNING.sizes)
        if (i + 1) * len(sizes) >= TUNING.sizes
    }
    several = {times * sizes[-1] for times in TUNING.multiples if times * sizes[-1] <= 1.0}
    return sorted({min(1.0, size) for size in some} | several)


def _rate(demand: Demand, part: float, window: float, share: float = 1.0) -> float:
    """Messages per second that such a part lets through in a share of all windows [1/s]: those that fit."""
    fitting = [size for size in demand.sizes if size <= part]
    if not fitting:
        return min(demand.rate, share * part / min(demand.sizes) / window)
    alike = math.floor(part / max(fitting) + 1e-9)
    together = max(alike, TUNING.packing * part * len(fitting) / sum(fitting))
    if demand.period > 0.0 and len(fitting) == len(demand.sizes):
        # Of a rhythm so many fit as lie between one and the first that is out of its window.
        window = demand.period * max(together, math.floor(window / demand.period + 1.0))
    return min(demand.rate * len(fitting) / len(demand.sizes), share * together / window)


def _hull(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Leave out what lies below a line between others, not on it: values per part then do not rise."""
    hull: list[tuple[float, float]] = []
    for x, y in points:
        while len(hull) > 1 and (y - hull[-1][1]) * (hull[-1][0] - hull[-2][0]) > (1.0 + ROUNDING) * (
            (hull[-1][1] - hull[-2][1]) * (x - hull[-1][0])
        ):
            hull.pop()
        hull.append((x, y))
    return [point for i, point in enumerate(hull) if not i or point[1] > hull[i - 1][1]]


def _turns(demand: Demand, part: float, window: float) -> list[Segment]:
    """Ask for a slot: the first message of several windows is worth most."""
    size = _units(UNIT * part)
    steps = [(quarters, demand.value(_rate(demand, part, window, quarters / QUARTERS))) for quarters in (1, 2, 4)]
    return [
        Segment(size, level_of((high - low) * QUARTERS / (size * (quarters - before))), quarters - before)
        for (before, low), (quarters, high) in pairwise([(0, 0.0), *steps])
        if high > low
    ]


def _units(amount: float) -> int:
    return max(1, min(UNIT, math.ceil(amount * (1.0 - ROUNDING))))
