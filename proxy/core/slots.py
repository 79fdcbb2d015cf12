"""Slots: what robots hold for long, where nobody knows their clocks well enough to lend for single messages.

A slot has room for one message of a stream in every window, and is lengthened for as long as its stream should have it.
So what a robot may be wrong about the clock of who lends is lost once, not with every message. Who should have one:
the next one goes where it gains most for what it takes, as long as there is room; that is exact where slots are small.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from planner import Aggregation
from planner.utility.base import Floats
from proxy.core.cadence import Cadences, Place
from proxy.core.limits import Limit, use_of
from proxy.core.offset import ClockOffset
from proxy.core.shares import LONG
from proxy.core.stream import Stream
from proxy.core.view import SharedView

STANDING = 0.1
"""Slots are lent where a robot may be wrong about our clock by this part of the shortest window."""
STAYS = 1.05
"""Who has a slot keeps it unless somebody else would gain so much more."""
LASTING = 60.0
"""Messages of which more than the most recent one counts are worth what they are for so long [s]."""
LOOK = 1.0
"""What is lent for long is lengthened so long before the robot would have none [s]..."""
RENEWED = 2.0
"""... by so much more [s]."""
LASTS = LONG + 0.01
"""It is for so long at least, however late it begins: what is shorter is given back when it was used [s]."""
LONGEST = 600.0
"""Nothing is lent for longer; then it is lent anew [s]."""
AWAITED = 15.0
"""Room for a stream that generated something is kept for so long until it is known how often it does [s]."""
MOST_SLOTS = 256
"""Slots at the same time."""
MARGIN = 1.01
"""Messages may be larger by so much than the last one of the stream."""


@dataclass(frozen=True, slots=True)
class Demand:
    """What a stream would gain by its first slot, its second, and so on [utility/s]; `use` is that of each.

    Until it is `known` how often it sends it has none, but nobody else has the room for one.
    """

    place: Place
    use: tuple[float, ...]
    gains: tuple[float, ...]
    known: bool = True


def lengthened_by(now: float, offset: ClockOffset) -> float:
    """When what a robot is lent for long must not end before it can have heard of more [s]."""
    return now + offset.latency + offset.uncertainty(now) + LOOK


def demands(now: float, view: SharedView, limits: Sequence[Limit], cadences: Cadences) -> list[Demand]:
    """Return what all streams that compete would gain, by robot and key; `limits` are those that robots share."""
    streams = view.competition.all(now)
    return [_demand(now, view, s, limits, cadences) for s in streams if _rhythmic(s) or now < s.newest.t_gen + AWAITED]


def allot(wanted: Sequence[Demand], room: Sequence[float], held: Mapping[Place, int]) -> dict[Place, int]:
    """Return how many slots each stream should have that now has those `held`, so that all fit into the `room`."""
    left, slots = list(room), dict.fromkeys((demand.place for demand in wanted), 0)
    for _ in range(MOST_SLOTS):
        best, most = None, 0.0
        for demand in wanted:
            count = slots[demand.place]
            part = max((use / whole for use, whole in zip(demand.use, room, strict=True)), default=0.0)
            if count == len(demand.gains) or not part or any(u > r for u, r in zip(demand.use, left, strict=True)):
                continue
            stays = STAYS if count < held.get(demand.place, 0) else 1.0
            if stays * demand.gains[count] / part > most:
                best, most = demand, stays * demand.gains[count] / part
        if best is None:
            break
        slots[best.place] += 1
        left = [r - u for r, u in zip(left, best.use, strict=True)]
    return slots


def _demand(now: float, view: SharedView, stream: Stream, limits: Sequence[Limit], cadences: Cadences) -> Demand:
    window = max((limit.window for limit in limits), default=0.0)
    audience, known = view.audiences.of(now, stream), cadences.of(now, stream, window)
    rates = _rates(stream, audience.mean, window) if known is None else np.array([each.rate for each in known])
    use = use_of(stream.newest.size, view.copies(stream), tuple(limits))
    gains = tuple(np.diff(stream.newest.scale * audience.share * rates, prepend=0.0).tolist())
    return Demand((stream.robot, stream.key), tuple(MARGIN * amount for amount in use), gains, _rhythmic(stream))


def _intervals(period: float, window: float) -> list[float]:
    most = min(MOST_SLOTS, math.floor(window / period + 1e-9) + 1)
    rounds = math.ceil(window / period - 1e-9) * period
    return [period if n == most else rounds / n for n in range(1, most + 1)]


def _rhythmic(stream: Stream) -> bool:
    return stream.schedule.period > 0.0


def _rates(stream: Stream, latency: float, window: float) -> Floats:
    """What one slot is worth to a stream, two, and so on, if it sends evenly [1/s]."""
    intervals = np.array(_intervals(max(stream.schedule.period, 1e-3), window) if _rhythmic(stream) else [window])
    recent = stream.information_type.aggregation is Aggregation.MOST_RECENT
    begin = np.full(len(intervals), latency)
    end = begin + (intervals if recent else LASTING)
    rates: Floats = stream.information_type.utility_of(stream.newest.features).integral(begin, end) / intervals
    return rates
