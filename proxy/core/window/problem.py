"""The problem of one decision, for the planner: its messages to decide, its facts, and the traffic beside them."""

import math
from collections.abc import Callable, Iterable
from functools import partial
from itertools import islice
from operator import attrgetter, itemgetter
from typing import Any, NamedTuple

from planner import Aggregation, Latest, Message, MessageUtility, Problem, Traffic
from planner import Stream as PlannerStream
from proxy.core.model.limits import Limits, longest_window, use_of
from proxy.core.model.waiting import Waiting
from proxy.core.view.stream import Generated, Sent
from proxy.core.window.forecast import Candidate
from proxy.core.window.tuning import TUNING


class OpenMessage(NamedTuple):
    """A message to decide: sent no sooner than `earliest`, it takes `latency` to the first who gains by it [s]."""

    t_gen: float
    place: int
    earliest: float
    latency: float
    utility: MessageUtility
    scale: float
    use: tuple[float, ...]
    current: bool = False


_Carried = tuple[float, float, MessageUtility, float, tuple[float, ...]]
"""Of an open message all from `earliest` to `use`: most of a stream have the same."""

_opened: Callable[[tuple[Any, ...]], OpenMessage] = partial(tuple.__new__, OpenMessage)
_message: Callable[[tuple[Any, ...]], Message] = partial(tuple.__new__, Message)
"""Make one of all its fields in half the time that calling its class takes: a window has a hundred of each."""


def published(now: float, waiting: Waiting, of: Candidate, limits: Limits, *, current: bool = False) -> OpenMessage:
    """Return a sample that waits as a message to decide."""
    return _opened((waiting.t_gen, of.place, *_carried(now, of, limits, waiting.size, waiting), current))


def expected(now: float, of: Candidate, times: Iterable[float], limits: Limits) -> list[OpenMessage]:
    """Return the samples that are forecast for these times as messages to decide."""
    stream, place = of.stream, of.place
    if not stream.forecasts:
        rest = *_carried(now, of, limits, of.size, stream.newest), False
        return [_opened((t, place, *rest)) for t in times]
    likes = [stream.expected(t) for t in times]
    alike = {id(like): _carried(now, of, limits, of.size, like) for like in likes}
    return [_opened((t, place, *alike[id(like)], False)) for t, like in zip(times, likes, strict=True)]


def _carried(now: float, of: Candidate, limits: Limits, size: int, like: Waiting | Generated) -> _Carried:
    use = use_of(size, of.copies, limits.union, own=of.own)
    utility = of.stream.information_type.utility_of(like.features)
    return now if of.own else -math.inf, of.audience.latency_of(size), utility, like.scale, use


class Contents(NamedTuple):
    """Who competes in a window, what is to decide, in order, and what guarantees demand besides."""

    candidates: list[Candidate]
    opened: list[OpenMessage]
    demanded: list[OpenMessage]


def problem(now: float, started: float, contents: Contents, limits: Limits) -> Problem:
    """Return the problem of a window; `started` is when this robot did [s]."""
    candidates, opened, demanded = contents
    union, nothing = limits.union, (0.0,) * len(limits.union)
    messages: list[Message] = []
    for c in candidates:
        messages += _facts(c, now, nothing)
    for m in demanded:
        t_sent = max(m.t_gen, now)
        received = t_sent + m.latency
        messages.append(Message(m.place, m.t_gen, t_sent, received, m.utility, m.scale, nothing, sent=True))
    t_sent, t_rcv = -math.inf, [-math.inf] * len(candidates)
    for t_gen, place, earliest, latency, utility, scale, use, is_current in opened:
        soonest = t_gen if t_gen > earliest else earliest  # noqa: FURB136 - calls take longer, for each of 100 messages
        t_sent = soonest if soonest > t_sent else t_sent  # noqa: FURB136
        received = t_sent + latency
        t_rcv[place] = received = received if received > t_rcv[place] else t_rcv[place]  # noqa: FURB136
        messages.append(_message((place, t_gen, t_sent, received, utility, scale, use, False)))
        if is_current:
            current = messages[-1]
    messages.sort(key=itemgetter(1, 0))
    robots = {robot: number for number, robot in enumerate(sorted({c.stream.robot for c in candidates}))}
    since, last = now - longest_window(union), candidates[opened[-1].place]
    traffic = [Traffic(t, each) for t, each in (*limits.others, *limits.sent) if t >= since]
    traffic += [Traffic(max(m.t_gen, now), m.use) for m in demanded]
    return Problem(
        streams=tuple([_stream(c, robots[c.stream.robot]) for c in candidates]),
        messages=tuple(messages),
        current=next(place for place, message in enumerate(messages) if message is current),
        constraints=union,
        traffic=tuple(sorted(traffic, key=attrgetter("t_sent"))),
        t_start=min(started, messages[0].t_gen),
        t_end=t_sent + last.audience.slowest + max(last.stream.schedule.period, TUNING.shortest_life),
    )


def _stream(c: Candidate, robot: int) -> PlannerStream:
    """Return a stream for the planner; of `current` its newest sample counts, sent or not."""
    kind, last = c.stream.information_type.aggregation, c.stream.newest
    newest = Latest(last.t_gen, last.scale) if kind is Aggregation.CURRENT else None
    return PlannerStream(robot, kind, c.audience.receivers, newest)


def _facts(c: Candidate, now: float, nothing: tuple[float, ...]) -> list[Message]:
    """Return what was sent of a stream as far as it matters for what comes; its use counts as traffic.

    Nothing where messages add up or reach each robot once; of `best`, what was received counts from now on.
    """
    recent = c.stream.recent
    if not recent or c.copy:  # what the robot of a copy has of the stream it had before it vanished
        return []
    if c.markovian:
        return [_fact(c, recent[-1], -math.inf, nothing)]
    kind = c.stream.information_type.aggregation
    if kind in (Aggregation.SUM, Aggregation.ONCE):
        return []
    since = now if kind is Aggregation.BEST else -math.inf
    return [_fact(c, each, since, nothing) for each in islice(reversed(recent), TUNING.facts_of_a_stream)]


def _fact(c: Candidate, sent: Sent, since: float, use: tuple[float, ...]) -> Message:
    utility = c.stream.information_type.utility_of(sent.features)
    t_rcv = max(sent.t_sent + c.audience.latency_of(sent.size), since)
    return _message((c.place, sent.t_gen, sent.t_sent, t_rcv, utility, sent.scale, use, True))
