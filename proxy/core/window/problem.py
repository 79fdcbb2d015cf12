"""The problem of one decision, for the planner: its messages to decide, its facts, and the traffic beside them."""

import math
from collections.abc import Mapping
from itertools import islice
from operator import attrgetter
from typing import NamedTuple

from planner import Aggregation, Message, Problem, Traffic
from planner import Stream as PlannerStream
from proxy.core.model.limits import Limits, longest_window, use_of
from proxy.core.model.waiting import Waiting
from proxy.core.view.stream import Sent
from proxy.core.window.candidates import Candidate
from proxy.core.window.tuning import TUNING

_SENT = attrgetter("t_sent")


class OpenMessage(NamedTuple):
    """A message to decide."""

    t_gen: float
    of: Candidate
    size: int
    scale: float
    features: Mapping[str, float]
    current: bool = False


def published(waiting: Waiting, of: Candidate, *, current: bool = False) -> OpenMessage:
    """Return a sample that waits as a message to decide."""
    return OpenMessage(waiting.t_gen, of, waiting.size, waiting.scale, waiting.features, current)


def expected(of: Candidate, t_gen: float) -> OpenMessage:
    """Return a sample that is forecast as a message to decide."""
    like = of.stream.expected(t_gen)
    return OpenMessage(t_gen, of, of.size, like.scale, like.features)


class Contents(NamedTuple):
    """Who competes in a window, what is to decide, in order, and what guarantees demand besides."""

    candidates: list[Candidate]
    opened: list[OpenMessage]
    demanded: list[OpenMessage]


def problem(now: float, started: float, contents: Contents, limits: Limits) -> Problem:
    """Return the problem of a window; `started` is when this robot did [s]."""
    candidates, opened, demanded = contents
    nothing = (0.0,) * len(limits.union)
    messages: list[tuple[Message, OpenMessage | None]] = [
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
    last = opened[-1].of
    return Problem(
        streams=tuple(
            PlannerStream(robots[c.stream.robot], c.stream.information_type.aggregation, c.audience.receivers)
            for c in candidates
        ),
        messages=tuple(message for message, _ in messages),
        current=current,
        constraints=limits.union,
        traffic=_traffic(now, demanded, limits, uses),
        t_start=min(started, messages[0][0].t_gen),
        t_end=t_sent + last.audience.slowest + max(last.stream.mean_interval, TUNING.shortest_life),
    )


def _order(entry: tuple[Message, OpenMessage | None]) -> tuple[float, int]:
    """Messages stand by generation time; candidates, and so their streams, by robot and key."""
    return entry[0].t_gen, entry[0].stream


class _Uses:
    """What messages use of all constraints of a problem: those of one size and as many copies use the same."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._known: dict[tuple[int, int, bool], tuple[float, ...]] = {}

    def of(self, m: OpenMessage) -> tuple[float, ...]:
        """Return what a message uses: of what robots do not share only our own do."""
        place = m.size, m.of.copies, m.of.own
        found = self._known.get(place)
        if found is None:
            found = self._known[place] = use_of(m.size, m.of.copies, self._limits.union, own=m.of.own)
        return found


def _traffic(now: float, demanded: list[OpenMessage], limits: Limits, uses: _Uses) -> tuple[Traffic, ...]:
    """Return everything known to be sent that the windows still count, and what guarantees demand."""
    longest = longest_window(limits.union)
    traffic = [Traffic(t, use) for t, use in (*limits.others, *limits.sent) if t >= now - longest]
    traffic += [Traffic(max(m.t_gen, now), uses.of(m)) for m in demanded]
    return tuple(sorted(traffic, key=_SENT))


def _message(m: OpenMessage, t_sent: float, t_rcv: float, use: tuple[float, ...]) -> Message:
    utility = m.of.stream.information_type.utility_of(m.features)
    return Message(m.of.place, m.t_gen, t_sent, t_rcv, utility, m.scale, use)


def _sent(m: OpenMessage, now: float) -> Sent:
    return Sent(m.t_gen, max(m.t_gen, now), m.size, m.scale, m.features)


def _facts(c: Candidate, now: float, nothing: tuple[float, ...]) -> list[Message]:
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
    return [_fact(c, each, since, nothing) for each in islice(reversed(stream.recent), TUNING.facts_of_a_stream)]


def _fact(c: Candidate, sent: Sent, since: float, use: tuple[float, ...]) -> Message:
    utility = c.stream.information_type.utility_of(sent.features)
    t_rcv = max(sent.t_sent + c.audience.latency_of(sent.size), since)
    return Message(c.place, sent.t_gen, sent.t_sent, t_rcv, utility, sent.scale, use, sent=True)
