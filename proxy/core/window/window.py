"""The planning window: which messages a decision looks at, and what they would use.

It holds contested messages alone (`disputes.py`); the others are booked, and the limits of the problem lower by as
much. It reaches `WINDOWS` of the longest constraint window, at most `horizon_time`, and at least to one forecast
message of every stream; a slower stream is weighed by its rate. If these are more than `horizon` messages, low-value
streams are thinned, not time. Where more streams compete than a window has messages, some have none in it: half of
the places are for the streams worth most per byte on the air, half for those that generate next, so that what is
imminent competes with what is valuable. Only streams that somebody wants compete, and where each robot has its part
only our own, for then no other stream can gain by what we leave. Sent messages are facts. Those that say what others of
their stream are still worth are messages: the last one, or the last few where the stream does not go by the most
recent one. What else was sent within a constraint window is traffic, for what it uses. What guarantees demand of the
future is a fact and traffic like that.
"""

import math
from bisect import insort
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from heapq import heapify, heappop, heapreplace
from itertools import islice
from operator import attrgetter
from typing import NamedTuple

from planner import Aggregation, Message, Problem, Traffic
from planner import Stream as PlannerStream
from proxy.core.coordination.claims import Claim, claim
from proxy.core.forecast.patterns import MEMORYLESS
from proxy.core.market.disputes import Disputes
from proxy.core.model.limits import Limit, Limits, changes_plans, longest_window, use_of
from proxy.core.model.waiting import Waiting
from proxy.core.view.paths import Audience
from proxy.core.view.stream import LEAST_PERIOD, Sent, Stream
from proxy.core.view.view import SharedView
from proxy.core.window.guarantees import guaranteed, owed

MOST_AHEAD = 512
"""Of one stream so many messages are forecast at most."""
LEAST_LEFT = 0.1
"""So much of a limit is left at least to what is contested."""
WINDOWS = 4.0
"""The window reaches so many of the longest constraint window: with random sizes and times 93.5 % of the bound, and
92.3 where it reached two expected sends of every stream besides."""
LEAST_LIFE = 1e-3
"""The last message of a window lives at least this long [s]."""
MOST_FACTS = 16
"""So many of the messages last sent of a stream are facts where more than one counts."""
MOST_OF_BEST = 24
"""So many forecasts of a stream are planned for where the best message counts: time grows with their square."""
CHOICE = 1.5
"""Where streams offer more than this times what the limits carry, plans expect the smallest samples to be sent, as many
as that: else a frame is sent beside which no other one fits, although two smaller ones come by and by. Two, four and
eight robots with frames of 26 kB sent 6, 9 and 3 % more bytes so, and two with frames of 60 kB 22 %."""
LEAST_CHOSEN = 0.05
"""No smaller part of the samples is expected to be sent."""
BULKY = 0.25
"""That is so of messages that take more than this part of a limit..."""
VARIED = 0.05
"""... whose sizes deviate by more than this part, and which come by a rhythm: of five robots with samples of random
sizes, worths and times twice as many windows were over the limit, with 2 % less utility."""
OVERHEARD = 0.05
"""What was sent we have overheard so much later at most, besides the latency and the stream's jitter [s]."""
MOST_OF_OWN = 3
"""So many waiting samples, and so many forecasts, of a stream with an aggregation of the operator's.

Most such models have a state for every set of messages; so these are 2^7 with the current one at most.
"""


@dataclass(slots=True)
class _Candidate:
    """A stream that competes, and when it is expected to generate; `place` is its number in the problem.

    Those that gain by its messages are its `audience`.
    """

    stream: Stream
    place: int
    copies: int
    audience: Audience
    own: bool
    markovian: bool
    times: list[float]
    size: int = 0
    """The size that its samples to come are planned with [B]."""
    copy: bool = False
    """Whether these are messages for one robot alone, which was away when they were generated."""

    @property
    def worth(self) -> float:
        """Value per byte on the air."""
        last = self.stream.newest
        return last.scale * self.audience.share / max(last.size * self.copies, 1)

    @property
    def standard(self) -> bool:
        """Whether the aggregation is the planner's own, not a model of the operator's."""
        return isinstance(self.stream.information_type.aggregation, Aggregation)


class _Open(NamedTuple):
    """A message to decide."""

    t_gen: float
    of: _Candidate
    size: int
    scale: float
    features: Mapping[str, float]
    current: bool = False


_SENT = attrgetter("t_sent")


class WindowBuilder:
    """Builds the problem of one decision from the shared view."""

    def __init__(self, view: SharedView, started: float) -> None:
        self._view = view
        self._started = started
        self.disputes = Disputes(view)
        """What is to decide, and what is load."""

    def build(self, now: float, current: Waiting, waiting: Iterable[Waiting], limits: Limits) -> Problem:
        """Return the problem of deciding `current` while others of our own samples are `waiting`."""
        return self.within(now, current, waiting, limits, math.inf)[0]

    def within(
        self, now: float, current: Waiting, waiting: Iterable[Waiting], limits: Limits, most: float
    ) -> tuple[Problem, int]:
        """Return the same with about `most` other messages to decide, and how many there would be of themselves.

        Half of the places are for samples that wait, those worth most, the rest for forecasts.
        """
        limits = self._contested(now, limits)
        candidates, opened, demanded, full = self._opened(now, current, list(waiting), limits, most)
        return self._problem(now, candidates, opened, demanded, limits), full

    def _contested(self, now: float, limits: Limits) -> Limits:
        """Return what is left of the limits to what is contested, without the sends that are booked."""
        disputes = self.disputes
        disputes.look(now, limits.union, alone=limits.alone)
        union = tuple(
            replace(c, limit=max(left, LEAST_LEFT * c.limit), window=window)
            for c, left, window in zip(limits.union, *disputes.left(now), strict=True)
        )
        sent, others = (disputes.unbooked(now, sends) for sends in (limits.sent, limits.others))
        return replace(limits, union=union, sent=sent, others=others)

    def _opened(
        self, now: float, current: Waiting, waiting: list[Waiting], limits: Limits, most: float
    ) -> tuple[list[_Candidate], list[_Open], list[_Open], int]:
        """Return who competes, what is to decide, what guarantees demand anyway, and how much there is to decide."""
        queued = int(min(len(waiting), most // 2))
        places = int(min(self._view.settings.horizon, most - queued))
        candidates = self._candidates(now, "" if current.to else current.key, limits, places)
        stream = self._view.known(self._view.settings.robot, current.key)
        end = self._forecast(now, candidates, limits, None if stream is None else claim(now, stream))
        demanded = [m for c in candidates if guaranteed(c.stream) for m in self._owed(c)]
        for c in candidates:
            if c.times and c.times[-1] > end:
                c.times = [t for t in c.times if t <= end]
            if not c.markovian:
                c.times = _bounded(c, c.times)
        full = len(waiting) + min(self._view.settings.horizon, sum([len(c.times) for c in candidates]))
        _thin(candidates, places)
        ours = {c.stream.key: c for c in candidates if c.own}
        opened = [_open(w, ours[w.key]) for w in _competing(waiting, ours)[:queued]]
        if current.to:
            candidates.append(self._copied(now, len(candidates), current))
        opened.append(_open(current, candidates[-1] if current.to else ours[current.key], current=True))
        opened += [_expect(c, t) for c in candidates for t in c.times]
        opened.sort(key=lambda m: (m.t_gen, m.of.place))
        return candidates, opened, demanded, full

    def _owed(self, c: _Candidate) -> list[_Open]:
        """Take what its guarantee demands out of the forecasts of a stream."""
        times = list(owed(c.stream, c.times, c.audience.slowest))
        c.times = [t for t in c.times if t not in times]
        return [_expect(c, t) for t in times]

    def _candidates(self, now: float, deciding: str, limits: Limits, most: int) -> list[_Candidate]:
        """Streams that compete, by robot and key, at most so many; that of the current message always does."""
        view, own = self._view, self._view.settings.robot
        competing = view.competition.chosen(now, most, own if limits.alone else None, self.disputes.settled)
        current = view.known(own, deciding)
        if current is not None and not any(s is current for s in competing):
            insort(competing, current, key=lambda s: (s.robot, s.key))
        return [self._candidate(now, place, stream) for place, stream in enumerate(competing)]

    def _candidate(self, now: float, place: int, stream: Stream) -> _Candidate:
        view, own = self._view, stream.robot == self._view.settings.robot
        markovian, audience = stream.information_type.markovian, view.audiences.of(now, stream)
        return _Candidate(stream, place, view.copies(stream), audience, own, markovian, [], stream.likely_size)

    def _copied(self, now: float, place: int, current: Waiting) -> _Candidate:
        """Return the stream of a copy, as it is for the one robot that the copy is for."""
        view, own = self._view, self._view.settings.robot
        stream = view.stream(now, own, current.key)
        if stream is None:
            raise LookupError(f"no type plans for {current.key}")
        audience = view.audiences.to(now, current.to, current.size)
        copies = 1 + view.settings.relayed
        return _Candidate(stream, place, copies, audience, own=True, markovian=False, times=[], copy=True)

    def _forecast(self, now: float, candidates: list[_Candidate], limits: Limits, ours: Claim | None) -> float:
        """Fill in the expected generation times of every candidate; return the end of the window.

        Others' messages since we last heard of them have an unknown fate: they are decisions too, but for those with a
        lesser claim than `ours`.
        """
        settings = self._view.settings
        longest = longest_window(limits.union)
        until = now + settings.horizon_time
        end = min(until, now + WINDOWS * longest)
        for c in candidates:
            after = self._since(now, c, limits, longest, ours)
            c.times = c.stream.schedule.forecast(after, end, MOST_AHEAD, now)
            if not c.times:
                c.times = c.stream.schedule.forecast(after, until, 1, now)
        _choose(candidates, limits.union)
        return max([end, *[c.times[0] for c in candidates if c.times]])

    def _since(self, now: float, c: _Candidate, limits: Limits, longest: float, ours: Claim | None) -> float:
        """Return when the first message of a stream was or will be generated whose fate is open."""
        view, stream = self._view, c.stream
        if c.own or (ours is not None and claim(now, stream) < ours):
            return now
        schedule = stream.schedule
        heard = schedule.last or now
        if stream.sent is not None:
            heard = max(heard, stream.sent.t_gen + 0.5 * schedule.period)
        if heard >= now:
            return heard
        use = use_of(stream.newest.size, c.copies, limits.union, own=False)
        if not (view.overhears(stream) or changes_plans(use, limits.union)):
            return max(heard, now - longest)
        return max(heard, now - self._way_here(c) - OVERHEARD - schedule.jitter)

    def _way_here(self, c: _Candidate) -> float:
        """What samples of another robot take to us [s]: others may be told of sooner."""
        sender = self._view.peer_called(c.stream.robot)
        line = None if sender is None else sender.line_in
        if sender is None or line is None:
            return c.audience.latency
        return max(line.of(c.stream.newest.size), sender.offset.latency)

    def _problem(
        self, now: float, candidates: list[_Candidate], opened: list[_Open], demanded: list[_Open], limits: Limits
    ) -> Problem:
        nothing = (0.0,) * len(limits.union)
        messages: list[tuple[Message, _Open | None]] = [
            (fact, None) for c in candidates for fact in _facts(c, now, nothing)
        ]
        messages += [(_fact(m.of, _sent(m, now), 0.0, nothing), None) for m in demanded]
        t_sent, uses = -math.inf, _Uses(limits)
        t_rcv = dict.fromkeys(range(len(candidates)), -math.inf)
        for m in opened:
            t_sent = max(t_sent, m.t_gen, now) if m.of.own else max(t_sent, m.t_gen)
            t_rcv[m.of.place] = max(t_rcv[m.of.place], t_sent + m.of.audience.latency_of(m.size))
            messages.append((_message(m, t_sent, t_rcv[m.of.place], uses.of(m)), m))
        robots = {robot: number for number, robot in enumerate(sorted({c.stream.robot for c in candidates}))}
        messages.sort(key=_order)
        current = next(place for place, (_, m) in enumerate(messages) if m is not None and m.current)
        return Problem(
            streams=tuple(
                PlannerStream(robots[c.stream.robot], c.stream.information_type.aggregation, c.audience.receivers)
                for c in candidates
            ),
            messages=tuple(message for message, _ in messages),
            current=current,
            constraints=limits.union,
            traffic=_traffic(now, demanded, limits, uses),
            t_start=min(self._started, messages[0][0].t_gen),
            t_end=t_sent + opened[-1].of.audience.slowest + max(opened[-1].of.stream.mean_interval, LEAST_LIFE),
        )


def _order(entry: tuple[Message, _Open | None]) -> tuple[float, int]:
    """Messages stand by generation time; candidates, and so their streams, by robot and key."""
    return entry[0].t_gen, entry[0].stream


class _Uses:
    """What messages use of all constraints of a problem: those of one size and as many copies use the same."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._known: dict[tuple[int, int, bool], tuple[float, ...]] = {}

    def of(self, m: _Open) -> tuple[float, ...]:
        """Return what a message uses: of what robots do not share only our own do."""
        place = m.size, m.of.copies, m.of.own
        found = self._known.get(place)
        if found is None:
            found = self._known[place] = use_of(m.size, m.of.copies, self._limits.union, own=m.of.own)
        return found


def _traffic(now: float, demanded: list[_Open], limits: Limits, uses: _Uses) -> tuple[Traffic, ...]:
    """Return everything known to be sent that the windows still count, and what guarantees demand."""
    longest = longest_window(limits.union)
    traffic = [Traffic(t, use) for t, use in (*limits.others, *limits.sent) if t >= now - longest]
    traffic += [Traffic(max(m.t_gen, now), uses.of(m)) for m in demanded]
    return tuple(sorted(traffic, key=_SENT))


def _message(m: _Open, t_sent: float, t_rcv: float, use: tuple[float, ...]) -> Message:
    utility = m.of.stream.information_type.utility_of(m.features)
    return Message(m.of.place, m.t_gen, t_sent, t_rcv, utility, m.scale, use)


def _open(waiting: Waiting, c: _Candidate, *, current: bool = False) -> _Open:
    return _Open(waiting.t_gen, c, waiting.size, waiting.scale, waiting.features, current)


def _expect(c: _Candidate, t_gen: float) -> _Open:
    like = c.stream.expected(t_gen)
    return _Open(t_gen, c, c.size, like.scale, like.features)


def _sent(m: _Open, now: float) -> Sent:
    return Sent(m.t_gen, max(m.t_gen, now), m.size, m.scale, m.features)


def _facts(c: _Candidate, now: float, nothing: tuple[float, ...]) -> list[Message]:
    """Return what was sent of a stream as far as it matters for what comes; its use counts as traffic.

    Nothing where messages add up, or where whom the first one reached is no receiver any more. Of `best`, what was
    received counts from now on: what it was worth before no decision can change.
    """
    stream = c.stream
    if c.copy:  # what its robot has of the stream it had before it vanished
        return []
    if c.markovian:
        return [_fact(c, stream.recent[-1], -math.inf, nothing)] if stream.recent else []
    kind = stream.information_type.aggregation
    if kind in (Aggregation.SUM, Aggregation.ONCE):
        return []
    since = now if kind is Aggregation.BEST else -math.inf
    return [_fact(c, each, since, nothing) for each in islice(reversed(stream.recent), MOST_FACTS)]


def _fact(c: _Candidate, sent: Sent, since: float, use: tuple[float, ...]) -> Message:
    utility = c.stream.information_type.utility_of(sent.features)
    t_rcv = max(sent.t_sent + c.audience.latency_of(sent.size), since)
    return Message(c.place, sent.t_gen, sent.t_sent, t_rcv, utility, sent.scale, use, sent=True)


def _competing(waiting: Iterable[Waiting], ours: Mapping[str, _Candidate]) -> list[Waiting]:
    """Return the samples that are weighed beside the current one; of a model of the operator's the most valuable."""
    chosen: list[Waiting] = []
    count: Counter[str] = Counter()
    for w in sorted(waiting, key=lambda w: (-w.scale, w.t_gen, w.sample)):
        of = ours.get(w.key)
        count[w.key] += 1
        if of is not None and (of.standard or count[w.key] <= MOST_OF_OWN):
            chosen.append(w)
    return chosen


def _bounded(c: _Candidate, times: list[float]) -> list[float]:
    """Halve the forecasts of a stream while they take too long to weigh."""
    most = MOST_OF_OWN
    if c.standard:
        most = MOST_OF_BEST if c.stream.information_type.aggregation is Aggregation.BEST else len(times)
    while len(times) > most:
        times = times[::2]
    return times


def _choose(candidates: list[_Candidate], limits: tuple[Limit, ...]) -> None:
    """Where far more is offered than can be sent expect only the smallest samples of bulky streams to be sent."""
    uses = [use_of(round(c.stream.mean_size), c.copies, limits, own=c.own) for c in candidates]
    periods = [max(c.stream.schedule.period, LEAST_PERIOD) for c in candidates]
    offered = [sum([use[k] / period for use, period in zip(uses, periods, strict=True)]) for k in range(len(limits))]
    carried = [CHOICE * c.limit / c.window / rate for c, rate in zip(limits, offered, strict=True) if rate > 0.0]
    part = max(LEAST_CHOSEN, min(carried, default=1.0))
    if part >= 1.0:
        return
    for c, use in zip(candidates, uses, strict=True):
        stream, bulky = c.stream, any(u > BULKY * limit.limit for u, limit in zip(use, limits, strict=True))
        varied = stream.size_deviation > VARIED * stream.mean_size and stream.schedule.kind != MEMORYLESS
        if bulky and varied and not guaranteed(stream):
            chosen = [t for i, t in enumerate(c.times) if int((i + 1) * part) > int(i * part)]
            c.times, c.size = chosen or c.times[-1:], stream.smallest(part)


def _thin(candidates: list[_Candidate], horizon: int) -> None:
    """Halve the forecasts that are worth least each until the window holds at most `horizon`."""
    excess = sum([len(c.times) for c in candidates]) - horizon
    if excess <= 0:
        return
    left = [(c.worth / len(c.times), c.place, c) for c in candidates if len(c.times) > 1]
    heapify(left)
    while excess > 0 and left:
        _, place, thickest = left[0]
        kept = thickest.times[::2]
        excess -= len(thickest.times) - len(kept)
        thickest.times = kept
        if len(kept) > 1:
            heapreplace(left, (thickest.worth / len(kept), place, thickest))
        else:
            heappop(left)
