"""What this robot asks for of what robots share, made of its streams."""

import math
from collections.abc import Iterator, Sequence
from functools import partial

from planner import Aggregation
from planner.utility import integral
from proxy.core.coordination.tuning import TUNING
from proxy.core.market.standing import interval_of, rate_known, variance_of
from proxy.core.model.lifetimes import worthless_from
from proxy.core.model.limits import Limit, use_of
from proxy.core.protocol.bid import Bid
from proxy.core.split.demand import Demand, bid_for, usual_message
from proxy.core.view.audience import Audience
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView


def bid(view: SharedView, now: float, limits: Sequence[Limit]) -> Bid:
    """Return what our streams ask for of the shared limit that they need most of."""
    window = max((limit.window for limit in limits if limit.shared), default=1.0)
    return bid_for(_demands(view, now, limits, window), window, view.members.speaking + 1)


def usual(view: SharedView, now: float, limits: Sequence[Limit]) -> int:
    """Return what a usual message takes of a shared limit [units], of our smallest large stream; 0: none is large."""
    window = max((limit.window for limit in limits if limit.shared), default=1.0)
    return usual_message(_demands(view, now, limits, window), view.members.speaking + 1)


def _demands(view: SharedView, now: float, limits: Sequence[Limit], window: float) -> Iterator[Demand]:
    shared = tuple(limit for limit in limits if limit.shared)
    for stream in view.streams.own():
        if not view.contention.competes(now, stream) or _late(stream, audience := view.audiences.of(now, stream)):
            continue
        copies, spread = view.subscribers.copies(stream), stream.sizes.deviation
        sizes = {max(1, round(stream.sizes.mean + off * spread)) for off in TUNING.size_deviations}
        parts = [
            max(use / limit.limit for use, limit in zip(use_of(size, copies, shared), shared, strict=True))
            for size in sorted(sizes)
        ]
        interval = interval_of(now, stream, window, TUNING.new_stream)
        if not (stream.information_type.markovian or rate_known(now, stream, window)):
            # It comes at random: after one alarm robots asked for three a window, and one of four had next to nothing.
            interval = max(interval, window / max(stream.generated, 1))
        mean = sum(parts) / len(parts)
        variance = variance_of(stream, window / interval, mean, mean * spread / max(stream.sizes.mean, 1.0))
        period = stream.schedule.period if stream.schedule.kind == "periodic" else 0.0
        yield Demand(parts, 1.0 / interval, partial(_value, stream, audience.share, period), variance, period)


def _late(stream: Stream, audience: Audience) -> bool:
    """Whether messages of a stream are worth nothing any more long before they are received."""
    return audience.share > 0.0 and audience.mean >= TUNING.too_late * worthless_from(stream.information_type.utility)


def _value(stream: Stream, share: float, period: float, rate: float) -> float:
    """Return the utility per second of so many messages per second, whole periods apart, if received at once.

    Taken evenly apart a second one in a window seemed worth as much as the first (ten robots with equal messages: 91.0
    to 98.7 % of a central decider, 92.9 to 99.4 now). With latencies, which each learns at another moment, all bid anew
    each time: frames of four robots at 1 s took 40 % of the limit instead of 50.
    """
    kind, like = stream.information_type, stream.newest
    utility, lasting = kind.utility_of(like.features), kind.aggregation in (Aggregation.SUM, Aggregation.ONCE)
    apart = TUNING.worthless if lasting else min(1.0 / max(rate, 1.0 / TUNING.worthless), TUNING.worthless)
    if lasting or not period:
        return integral(utility, apart) * like.scale * share * rate
    periods = max(1, math.floor(apart / period))
    later = min(1.0, max(0.0, apart / period - periods))
    each = (1.0 - later) * integral(utility, periods * period) + later * integral(utility, (periods + 1) * period)
    return each * like.scale * share * rate
