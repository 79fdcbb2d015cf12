"""The problem of one decision, for the planner: its messages to decide, its facts, and the traffic beside them."""

import math
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from itertools import islice
from operator import attrgetter, itemgetter
from typing import Any, NamedTuple

from planner import Aggregation, Latest, Message, MessageUtility, Problem, Traffic
from planner import Stream as PlannerStream
from proxy.core.model.limits import Limits, longest_window, use_of
from proxy.core.model.waiting import Waiting
from proxy.core.view.stream import Sent
from proxy.core.window.forecast import Candidate
from proxy.core.window.tuning import TUNING


class OpenMessage(NamedTuple):
    """A message to decide."""

    t_gen: float
    place: int
    of: Candidate
    size: int
    scale: float
    features: Mapping[str, float]
    current: bool = False


_opened: Callable[[tuple[Any, ...]], OpenMessage] = partial(tuple.__new__, OpenMessage)
_message: Callable[[tuple[Any, ...]], Message] = partial(tuple.__new__, Message)
"""Make one of all its fields in half the time that calling its class takes: a window has a hundred of each."""


def published(waiting: Waiting, of: Candidate, *, current: bool = False) -> OpenMessage:
    """Return a sample that waits as a message to decide."""
    return OpenMessage(waiting.t_gen, of.place, of, waiting.size, waiting.scale, waiting.features, current)


def expected(of: Candidate, times: Iterable[float]) -> list[OpenMessage]:
    """Return the samples that are forecast for these times as messages to decide."""
    stream, place, size = of.stream, of.place, of.size
    if stream.forecasts:
        return [_opened((t, place, of, size, *stream.expected(t)[2:], False)) for t in times]
    _, _, scale, features = stream.newest
    return [_opened((t, place, of, size, scale, features, False)) for t in times]


class Contents(NamedTuple):
    """Who competes in a window, what is to decide, in order, and what guarantees demand besides."""

    candidates: list[Candidate]
    opened: list[OpenMessage]
    demanded: list[OpenMessage]


def problem(now: float, started: float, contents: Contents, limits: Limits) -> Problem:
    """Return the problem of a window; `started` is when this robot did [s]."""
    candidates, opened, demanded = contents
    union, nothing = limits.union, (0.0,) * len(limits.union)
    alike: dict[tuple[int, int, int], tuple[float, MessageUtility, tuple[float, ...], float]] = {}
    """What messages of one stream take, are, use and wait for that are of one size and show the same: as most do."""

    messages = [fact for c in candidates for fact in _facts(c, now, nothing)]
    for m in demanded:
        sent = Sent(m.t_gen, max(m.t_gen, now), m.size, m.scale, m.features)
        messages.append(_fact(m.of, sent, 0.0, nothing))
    t_sent, t_rcv = -math.inf, [-math.inf] * len(candidates)
    for t_gen, place, of, size, scale, features, is_current in opened:
        kind = place, size, id(features)
        if (known := alike.get(kind)) is None:
            utility, uses = of.stream.information_type.utility_of(features), use_of(size, of.copies, union, own=of.own)
            known = alike[kind] = of.audience.latency_of(size), utility, uses, now if of.own else -math.inf
        latency, utility, uses, earliest = known
        t_sent = max(t_sent, t_gen, earliest)
        t_rcv[place] = received = max(t_rcv[place], t_sent + latency)
        messages.append(_message((place, t_gen, t_sent, received, utility, scale, uses, False)))
        if is_current:
            current = messages[-1]
    messages.sort(key=itemgetter(1, 0))
    robots = {robot: number for number, robot in enumerate(sorted({c.stream.robot for c in candidates}))}
    since, last = now - longest_window(union), opened[-1].of
    traffic = [Traffic(t, each) for t, each in (*limits.others, *limits.sent) if t >= since]
    traffic += [Traffic(max(m.t_gen, now), use_of(m.size, m.of.copies, union, own=m.of.own)) for m in demanded]
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
    stream = c.stream
    if c.copy:  # what its robot has of the stream it had before it vanished
        return []
    if c.markovian:
        return [_fact(c, stream.recent[-1], -math.inf, nothing)] if stream.recent else []
    kind = stream.information_type.aggregation
    if kind in (Aggregation.SUM, Aggregation.ONCE):
        return []
    since = now if kind is Aggregation.BEST else -math.inf
    return [_fact(c, each, since, nothing) for each in islice(reversed(stream.recent), TUNING.facts_of_a_stream)]


def _fact(c: Candidate, sent: Sent, since: float, use: tuple[float, ...]) -> Message:
    utility = c.stream.information_type.utility_of(sent.features)
    t_rcv = max(sent.t_sent + c.audience.latency_of(sent.size), since)
    return Message(c.place, sent.t_gen, sent.t_sent, t_rcv, utility, sent.scale, use, sent=True)
