"""A bid out of a robot's own streams: what they need and what it is worth."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby

from proxy.core.split.bid import MOST_SEGMENTS, UNIT, Bid, Segment, level_of

SMALL = 0.05
"""Messages up to this part of a limit are asked for as divisible room, at most half of an equal part."""
RATES = (0.25, 0.5, 1.0, 2.0, 3.0)
"""Rates at which large messages are asked for, in uses of a slot per window."""
PACKED = 0.85
"""What of a slot is used by messages that vary in size: a smaller one than the slot leaves some room."""


@dataclass(frozen=True, slots=True)
class Demand:
    """What one stream asks for: a message uses `mean` of the limit, seldom more than `large`, all copies counted."""

    mean: float
    large: float
    rate: float
    """Messages that it generates [1/s]."""
    value: Callable[[float], float]
    """Utility per second when so many messages per second are sent; concave."""


def bid_for(demands: Iterable[Demand], window: float, robots: int) -> Bid:
    """Return what streams ask for together of a limit with this window [s], among so many robots."""
    small = min(SMALL, 0.5 / max(1, robots))
    segments: list[Segment] = []
    divisible: list[tuple[float, float]] = []
    for demand in demands:
        if demand.rate <= 0.0 or demand.mean <= 0.0:
            continue
        if demand.large <= small:
            divisible.append(_room(demand, window))
        elif demand.large <= 1.0:
            segments += _large(demand, window)
    segments += _joined(divisible, MOST_SEGMENTS // 2)
    segments = sorted(segments, key=lambda s: (-s.level, s.quarters, s.amount))
    return tuple(segments[:MOST_SEGMENTS])


def _room(demand: Demand, window: float) -> tuple[float, float]:
    """What a stream of small messages needs in a window [units], one message beyond the mean, and its value density."""
    amount = UNIT * (demand.mean * demand.rate * window + demand.large)
    return amount, demand.value(demand.rate) / amount


def _joined(rooms: Sequence[tuple[float, float]], most: int) -> list[Segment]:
    """Put what is worth the same into one segment, and what is worth about the same where there are too many."""
    ranked = sorted(((level_of(density), amount) for amount, density in rooms), reverse=True)
    levels = [(level, sum(amount for _, amount in same)) for level, same in groupby(ranked, key=lambda room: room[0])]
    while len(levels) > most:
        at = min(range(len(levels) - 1), key=lambda i: levels[i][0] - levels[i + 1][0])
        (high, one), (low, other) = levels[at : at + 2]
        levels[at : at + 2] = [(round((high * one + low * other) / (one + other)), one + other)]
    return [Segment(min(UNIT, math.ceil(amount)), level) for level, amount in levels]


def _large(demand: Demand, window: float) -> list[Segment]:
    """Ask for slots: the first message of several windows is worth most, the second one of a window less."""
    size = min(UNIT, math.ceil(UNIT * demand.large))
    together = max(1.0, PACKED * demand.large / demand.mean)
    segments, before, value = [], 0.0, 0.0
    for uses in RATES:
        if before * together >= demand.rate * window:
            break
        worth = demand.value(min(demand.rate, uses * together / window))
        density = (worth - value) / ((uses - before) * size)
        segments.append(Segment(size, level_of(density), round(4 * min(1.0, uses - before))))
        before, value = uses, worth
    return segments
