"""How a stream stands in the market, and what it uses of limits in the mean: what needs no prices."""

import math
from collections.abc import Iterable, Sequence
from enum import Enum
from typing import NamedTuple

from planner import Aggregation
from proxy.core.market.tuning import TUNING
from proxy.core.model.limits import Limit, use_of
from proxy.core.view.audience import Audience, Audiences
from proxy.core.view.stream import Stream
from proxy.core.view.view import SharedView
from utility_specs.lifetimes import initial

Amounts = tuple[float, ...]


class Standing(Enum):
    """How a stream, or a sample, stands."""

    UNDISPUTED = "undisputed"
    PRICED = "priced"
    CONTESTED = "contested"
    HOPELESS = "hopeless"


class Weighed(NamedTuple):
    """How a stream stands whose samples are worth `scale`: it comes every `interval`, should be sent every `apart` [s].

    A sample's room costs so much; it earns `least` where all are sent, `most` where hardly any is [utility·s]. Each
    unit of excess loses it `relief` a second, where it is one of `current` [1/s].
    """

    standing: Standing
    scale: float
    interval: float
    apart: float
    cost: float = 0.0
    least: float = 0.0
    most: float = 0.0
    relief: float = 0.0

    @property
    def outweighs(self) -> bool:
        """Whether each sample earns many times its price: where each counts it waits as long as it is worth half.

        Four robots lost a third of their alarms on 20 kbit/s, which take a seventh of it: they were contested, as they
        are not small, waited a window for room that their own robot leaves, and odometry took what others left.
        """
        return self.least > TUNING.new_price * self.cost > 0.0

    def relieves(self, excess: float) -> bool:
        """Whether a sample pays by ending that so much too much is shown, until the stream would send anyhow."""
        return excess > 0.0 and self.relief * excess * min(self.apart, TUNING.longest * self.interval) > self.cost


UNKNOWN = Weighed(Standing.CONTESTED, 0.0, 0.0, 0.0)


class Row(NamedTuple):
    """A stream as it is weighed: its mean `interval`, the `age` of its samples at receipt [s], what a sample uses.

    Of each limit the mean and the deviation. `scale` and `relief`, the loss of a unit of excess [1/s], count all
    receivers.
    """

    stream: Stream
    interval: float
    age: float
    scale: float
    use: Amounts
    deviation: Amounts
    relief: float = 0.0

    def takes_at_most(self, part: float, limits: Sequence[Limit]) -> bool:
        """Whether its messages take no more than this part of every limit."""
        for use, deviation, limit in zip(self.use, self.deviation, limits, strict=True):
            if use + deviation > part * limit.limit:
                return False
        return True

    def has_room(self, limits: Sequence[Limit]) -> bool:
        """Whether limits that are our part are as large as its messages; others have no turn now, and set no price."""
        return all(use <= c.limit for use, c in zip(self.use, limits, strict=True))


def rows_of(
    now: float,
    view: SharedView,
    audiences: Audiences,
    streams: Sequence[Stream],
    limits: tuple[Limit, ...],
    *,
    new: int,
) -> list[Row]:
    """Return a row of each of the streams, which compete for these limits; so many that compete are `new`."""
    of, copies, robot, until = audiences.of, view.subscribers.copies, view.settings.robot, view.staleness.known_until
    return [row_of(until(now, s), s, of(now, s), copies(s), limits, own=s.robot == robot, new=new) for s in streams]


def row_of(
    until: float, stream: Stream, audience: Audience, copies: int, limits: tuple[Limit, ...], *, own: bool, new: int = 1
) -> Row:
    """Return a stream that is known `until` then [s], and goes to this audience, as a row; so many are `new`."""
    size = round(stream.sizes.mean)
    use = more = use_of(size, copies, limits, own=own)
    if spread := round(stream.sizes.deviation):
        more = use_of(size + spread, copies, limits, own=own)
    return Row(
        stream,
        interval_of(until, stream, min([c.window for c in limits]), new=new),
        audience.mean,
        stream.newest.scale * audience.share,
        use,
        tuple([m - u for m, u in zip(more, use, strict=True)]),
        _relief(stream, audience.share),
    )


def _relief(stream: Stream, share: float) -> float:
    kind = stream.information_type
    return initial(kind.utility) * share if kind.aggregation is Aggregation.CURRENT else 0.0


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
            if deviations > 0.0:
                variance += variance_of(row.stream, count, row.use[k], row.deviation[k])
        booked.append(mean + deviations * math.sqrt(variance))
    return tuple(booked)


def load_of(weighed: Iterable[tuple[Row, Weighed]]) -> tuple[list[Row], list[float]]:
    """Return the streams that are no decision and go beside contested ones, and how far apart each sends [s]."""
    load = [(row, w) for row, w in weighed if w.standing in (Standing.UNDISPUTED, Standing.PRICED)]
    apart = [w.apart if w.standing is Standing.PRICED else row.interval for row, w in load]
    return [row for row, _ in load], apart


def variance_of(stream: Stream, count: float, use: float, deviation: float) -> float:
    """Return the variance of what a stream uses in a window: so many samples in the mean, each of such a use."""
    return _spread(stream, count) * use**2 + count * deviation**2


def interval_of(now: float, stream: Stream, window: float, most: float = 2.0, new: int = 1) -> float:
    """Return the mean time between samples [s].

    A new stream generates in a window at most so many times as many as so far, and no faster than with two more; of
    many that are `new` not all do: of 2,000 keys of one sample each all seemed to go on for 7 s, and do for 2.
    """
    if rate_known(now, stream, window):
        return stream.period
    window = min(window, TUNING.rate_time)
    count = max(stream.generated - 0.5, 0.0) + TUNING.new_samples / math.sqrt(new)
    return max(stream.period, window / (most * max(stream.generated, 1)), (now - stream.began) / count)


def count_new(now: float, streams: Iterable[Stream], limits: Sequence[Limit]) -> int:
    """Return of how many streams it is not known how often they generate, one at least."""
    window = min((c.window for c in limits), default=0.0)
    return max(1, sum(not rate_known(now, stream, window) for stream in streams))


def rate_known(now: float, stream: Stream, window: float) -> bool:
    """Whether it is known how often a stream generates: from several samples, over a window [s], or long enough."""
    return stream.generated >= TUNING.rate_samples and now - stream.began >= min(window, TUNING.rate_time)


def _spread(stream: Stream, count: float) -> float:
    """Return the variance of how many samples a stream generates in a window, `count` in the mean."""
    if _is_periodic(stream):
        part = count - math.floor(count)
        return max(part * (1.0 - part), TUNING.least_variance)
    return count + count * count if stream.schedule.kind.startswith("bursts") else count


def _is_periodic(stream: Stream) -> bool:
    return stream.schedule.kind.startswith("periodic")


class UnderWay(NamedTuple):
    """What others may just have sent of each limit, undisputed: the mean and the variance of what they use in a second.

    Eight robots with streams of 2 to 10 Hz had 10 % of the windows over the limit without it (2 and 20 ms, broadcast),
    and have 7 and 5, for 3 and 2 % of the utility.
    """

    mean: Amounts = ()
    variance: Amounts = ()

    @classmethod
    def of(cls, sending: Sequence[tuple[Row, float]], limits: int) -> "UnderWay":
        """Return it of streams of others, each with how far apart it sends [s], under so many limits."""
        mean = tuple([sum([row.use[k] / apart for row, apart in sending]) for k in range(limits)])
        return cls(mean, tuple([sum([row.use[k] ** 2 / apart for row, apart in sending]) for k in range(limits)]))

    def beside(self, use: Amounts, time: float) -> Amounts:
        """Return the use of a message, and of what is under way beside it where news take so long [s]."""
        if len(use) != len(self.mean):
            return use
        return tuple(
            [
                u + time * mean + math.sqrt(time * variance) if u > 0.0 else u
                for u, mean, variance in zip(use, self.mean, self.variance, strict=True)
            ]
        )
