"""The streams that compete in a window, which messages are to be expected of them, and how far ahead it looks.

A sample is *owed* by a guarantee when its stream would else be without one for too long; plans take it for sent.
"""

import math
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from heapq import heapify, heappop, heapreplace

from planner import Aggregation
from proxy.core.coordination.claims import claim
from proxy.core.forecast.patterns import MEMORYLESS
from proxy.core.model.limits import Limit, Limits, changes_plans, longest_window, use_of
from proxy.core.model.tuning import TUNING as MODEL
from proxy.core.view.audience import Audience
from proxy.core.view.stream import Stream, at_stake
from proxy.core.view.tuning import TUNING as VIEW
from proxy.core.view.view import SharedView
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


@dataclass(slots=True)
class Candidate:
    """A stream that competes, number `place` of the problem; its samples go in so many `copies` to its `audience`."""

    stream: Stream
    place: int
    copies: int
    audience: Audience
    own: bool
    markovian: bool
    size: int = 0
    """The size that its samples to come are planned with [B]."""
    copy: bool = False
    """Whether these are messages for one robot alone, which was away when they were generated."""
    times: list[float] = field(default_factory=list)
    """When it is expected to generate [s]."""

    @property
    def worth(self) -> float:
        """Value per byte on the air."""
        last = self.stream.newest
        return at_stake(self.stream, last.scale) * self.audience.share / max(last.size * self.copies, 1)

    @property
    def standard(self) -> bool:
        """Whether the aggregation is the planner's own, not a model of the operator's."""
        return isinstance(self.stream.information_type.aggregation, Aggregation)

    def expect(self, times: list[float], size: int | None = None) -> None:
        """Its samples are expected at these times [s], of that size [B] if it is given."""
        self.times = times
        self.size = self.size if size is None else size

    def take_owed(self) -> list[float]:
        """Take what its guarantee demands out of the times; return it."""
        times = list(owed(self.stream, self.times, self.audience.slowest))
        self.times = [t for t in self.times if t not in times]
        return times

    def bound(self, end: float) -> None:
        """Expect nothing after `end` [s], and no more than it does not take too long to weigh."""
        if self.times and self.times[-1] > end:
            self.times = [t for t in self.times if t <= end]
        if self.markovian or (self.standard and self.stream.information_type.aggregation is not Aggregation.BEST):
            return
        while len(self.times) > (TUNING.forecasts_of_best if self.standard else TUNING.messages_of_a_model):
            self.halve()

    def halve(self) -> int:
        """Leave out every other time; return how many that are."""
        before = len(self.times)
        self.times = self.times[::2]
        return before - len(self.times)


def thin(candidates: list[Candidate], most: int) -> None:
    """Halve the forecasts that are worth least each until there are at most so many, or one of each stream."""
    excess = sum([len(c.times) for c in candidates]) - most
    if excess <= 0:
        return
    left = [(c.worth / len(c.times), c.place, c) for c in candidates if len(c.times) > 1]
    heapify(left)
    while excess > 0 and left:
        _, place, thickest = left[0]
        excess -= thickest.halve()
        if len(thickest.times) > 1:
            heapreplace(left, (thickest.worth / len(thickest.times), place, thickest))
        else:
            heappop(left)


def forecast(
    now: float, view: SharedView, candidates: list[Candidate], limits: Limits, deciding: Stream | None
) -> None:
    """Fill in the expected generation times of every candidate, as far ahead as plans look.

    Others' messages since we last heard of them are decisions, too, but for those with a lesser claim than `deciding`.
    """
    longest, until = longest_window(limits.union), now + view.settings.horizon_time
    end, ours = min(until, now + MODEL.planned_windows * longest), None
    for c in candidates:
        decided = c.own
        if not decided and deciding is not None and not limits.agreed:
            ours = ours or claim(now, deciding)
            decided = claim(now, c.stream) < ours
        after = now if decided else _unheard_since(now, view, c, limits, longest)
        c.expect(c.stream.schedule.ahead(now, after, end, TUNING.forecasts_of_a_stream, until))
    if not limits.alone:
        _choose(candidates, limits.union)


def reach(now: float, candidates: list[Candidate], limits: Limits, most: int) -> float:
    """Return until when a window looks ahead that holds so many messages [s], one of limits at least (2.3 % at 40)."""
    times = sorted([t for c in candidates for t in c.times])
    if len(times) > most:
        times = times[: max(most, bisect_right(times, now + longest_window(limits.union)))]
    return max([times[-1] if times else now, *[c.times[0] for c in candidates if c.times]])


def _unheard_since(now: float, view: SharedView, c: Candidate, limits: Limits, longest: float) -> float:
    """Return when the first message of another robot's stream was or will be generated whose fate is open [s]."""
    stream, schedule = c.stream, c.stream.schedule
    heard = schedule.last or now
    if stream.sent is not None:
        heard = max(heard, stream.sent.t_gen + 0.5 * schedule.period)
    if heard >= now:
        return heard
    use = use_of(stream.newest.size, c.copies, limits.union, own=False)
    if not (view.subscribers.overhears(stream.robot) or changes_plans(use, limits.union)):
        return max(heard, now - longest)
    within = (TUNING.agreed_within if limits.agreed else TUNING.overheard_within) + view.staleness.delay
    return max(heard, now - _latency(view, c) - within - schedule.jitter)


def _latency(view: SharedView, c: Candidate) -> float:
    """What samples of another robot take to us [s]: others may hear of them sooner."""
    sender = view.members.called(c.stream.robot)
    line = None if sender is None else sender.inbound.line
    if sender is None or line is None:
        return c.audience.latency
    return max(line.of(c.stream.newest.size), sender.offset.latency)


def _choose(candidates: list[Candidate], limits: tuple[Limit, ...]) -> None:
    """Where far more is offered than can be sent expect only the smallest samples of bulky streams to be sent.

    Not within a part of ours, with seldom another one to choose: thirty robots reached 92 % of central, not 96.
    """
    varied = [c for c in candidates if _is_varied(c.stream)]
    if not varied:
        return
    uses = [use_of(round(c.stream.sizes.mean), c.copies, limits, own=c.own) for c in candidates]
    rates = [1.0 / max(c.stream.schedule.period, VIEW.least_period) for c in candidates]
    offers = [[rate * u for u in use] for rate, use in zip(rates, uses, strict=True)]
    if _sent_part(offers, limits) >= 1.0:
        return
    worths = [c.worth for c in candidates]
    for c in varied:
        if not any(u > TUNING.bulky * limit.limit for u, limit in zip(uses[c.place], limits, strict=True)):
            continue
        least = TUNING.rival_worth * worths[c.place]
        part = _sent_part([offer for offer, other in zip(offers, worths, strict=True) if other >= least], limits)
        if part < 1.0:
            chosen = [t for i, t in enumerate(c.times) if int((i + 1) * part) > int(i * part)]
            c.expect(chosen or c.times[-1:], c.stream.sizes.smallest(part))


def _is_varied(stream: Stream) -> bool:
    """Whether smaller samples of a stream may be waited for: its sizes vary, and it is known when it generates."""
    varied = stream.sizes.deviation > TUNING.varied * stream.sizes.mean and stream.schedule.kind != MEMORYLESS
    return varied and not guaranteed(stream)


def _sent_part(offers: Sequence[Sequence[float]], limits: tuple[Limit, ...]) -> float:
    """Return what part of the samples is expected to be sent of streams that offer so much [limits' units/s]."""
    offered = [sum([offer[k] for offer in offers]) for k in range(len(limits))]
    carried = [
        TUNING.offered * limit.limit / limit.window / rate
        for limit, rate in zip(limits, offered, strict=True)
        if rate > 0.0
    ]
    return max(TUNING.sent_at_least, min(carried, default=1.0))
