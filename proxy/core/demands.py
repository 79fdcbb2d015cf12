"""What this robot asks for of what robots share, made of its streams."""

from collections.abc import Iterator, Sequence
from functools import partial

from planner import Aggregation
from proxy.core.limits import Limit, use_of
from proxy.core.prices import interval_of, variance_of
from proxy.core.split import Bid, Demand, bid_for
from proxy.core.stream import Stream
from proxy.core.view import SharedView
from utility_specs.lifetimes import integral

FOREVER = 3600.0
"""Messages are worth nothing any more after this [s]."""
AGAIN = 4.0
"""A new stream may generate so many times as much in a window as it has so far: of one sample nobody knows its period,
and a robot whose first alarm came asked for two thirds of the limit."""
SPREAD = (-1.2, -0.7, -0.2, 0.2, 0.7, 1.2, 2.0)
"""Sizes of a stream are taken to be so many standard deviations from their mean."""


def bid(view: SharedView, now: float, limits: Sequence[Limit]) -> Bid:
    """Return what our streams ask for of the shared limit that they need most of."""
    shared = tuple(limit for limit in limits if limit.shared)
    window = max((limit.window for limit in shared), default=1.0)
    return bid_for(_demands(view, now, shared, window), window, len(view.peers) + 1)


def _demands(view: SharedView, now: float, shared: tuple[Limit, ...], window: float) -> Iterator[Demand]:
    for stream in view.own():
        if not view.competes(now, stream):
            continue
        copies, spread = view.copies(stream), stream.size_deviation
        sizes = {max(1, round(stream.mean_size + off * spread)) for off in SPREAD}
        parts = [
            max(use / limit.limit for use, limit in zip(use_of(size, copies, shared), shared, strict=True))
            for size in sorted(sizes)
        ]
        share, interval = view.audiences.of(now, stream).share, interval_of(now, stream, window, AGAIN)
        mean = sum(parts) / len(parts)
        variance = variance_of(stream, window / interval, mean, mean * spread / max(stream.mean_size, 1.0))
        yield Demand(parts, 1.0 / interval, partial(_value, stream, share), variance)


def _value(stream: Stream, share: float, rate: float) -> float:
    """Return the utility per second of so many messages per second.

    As if they were received at once: how long they take each robot learns at another moment, and where bids depended on
    it all changed theirs then, and agreed for 20 s (ten robots whose news take 1 s; what takes as long to all is no
    reason to share otherwise).
    """
    kind, like = stream.information_type, stream.newest
    lasting = kind.aggregation in (Aggregation.SUM, Aggregation.ONCE)
    until = FOREVER if lasting else 1.0 / max(rate, 1.0 / FOREVER)
    return integral(kind.utility_of(like.features), until) * like.scale * share * rate
