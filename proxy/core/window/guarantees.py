"""What streams are guaranteed: samples that go whatever they are worth, as far as the limits allow.

A sample is *owed* when its stream would else be without one for too long. Plans take those to come for sent.
"""

import math
from collections.abc import Iterable, Iterator

from proxy.core.view.stream import Stream
from proxy.core.window.tuning import TUNING


def guaranteed(stream: Stream) -> bool:
    """Whether a stream is guaranteed anything."""
    return stream.information_type.guarantee.rate > 0.0


def longest(stream: Stream, latency: float) -> float:
    """How far apart samples may be generated that are sent, at a latency [s]; without end where nothing is said."""
    guarantee = stream.information_type.guarantee
    rate = 1.0 / guarantee.min_rate if guarantee.min_rate else math.inf
    age = max(0.0, guarantee.max_age - latency) if guarantee.max_age else math.inf
    return min(rate, age)


def owed(stream: Stream, times: Iterable[float], latency: float) -> Iterator[float]:
    """Yield those generation times of samples [s] that must be sent."""
    apart, ahead = longest(stream, latency), (1.0 - TUNING.early) * stream.schedule.period
    before = -math.inf if stream.sent is None else stream.sent.t_gen
    for t in times:
        if t + ahead - before > apart:
            yield t
            before = t
