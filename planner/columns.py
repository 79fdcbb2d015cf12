"""A problem as columns: messages, receivers and traffic as arrays, read once for all that is tabulated from them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from operator import attrgetter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from planner.utility import Flags, Floats, Ints, MessageUtility
from planner.utility.base import told_apart

if TYPE_CHECKING:
    from planner.problem import Aggregation, AggregationModel, Problem, Stream

_RECEIVER = attrgetter("delay", "share")


class Columns(NamedTuple):
    """By message: its stream, whether it is `sent`, times [s], scale, and `use[m, k]` of constraint k.

    `opened` are the messages to decide. Utilities that messages share are there once: message m has
    `utilities[utility[m]]`. Streams of one aggregation are together in `kinds`, the one that comes first
    first. By stream and receiver, filled up with receivers of no share: `delay` [s] and
    `share`. Of the traffic: `traffic_sent` [s] and `traffic_use[j, k]`.
    """

    stream: Ints
    sent: Flags
    opened: Ints
    times: Floats
    """t_gen, t_sent and t_rcv, one row each."""
    scale: Floats
    utilities: list[MessageUtility]
    utility: Ints
    use: Floats
    kinds: tuple[tuple[Aggregation | AggregationModel, list[int]], ...]
    delay: Floats
    share: Floats
    traffic_sent: Floats
    traffic_use: Floats

    @property
    def t_gen(self) -> Floats:
        """When each message is generated [s]."""
        return np.asarray(self.times[0])

    @property
    def t_sent(self) -> Floats:
        """When each message is sent [s]."""
        return np.asarray(self.times[1])

    @property
    def t_rcv(self) -> Floats:
        """When each message is received [s]."""
        return np.asarray(self.times[2])


def columns_of(problem: Problem) -> Columns:
    """Read the columns of a problem with messages, in which every `use` has an entry for each constraint."""
    messages, constraints = problem.messages, len(problem.constraints)
    stream, t_gen, t_sent, t_rcv, of_each, scale, use, sent = zip(*messages, strict=True)
    facts = np.array(sent, dtype=np.bool_)
    delay, share = _receivers(problem.streams)
    utilities, utility = told_apart(of_each)
    traffic_sent, traffic_use = zip(*problem.traffic, strict=True) if problem.traffic else ((), ())
    return Columns(
        stream=np.array(stream, dtype=np.int64),
        sent=facts,
        opened=np.flatnonzero(~facts),
        times=np.array((t_gen, t_sent, t_rcv), dtype=np.float64),
        scale=np.array(scale, dtype=np.float64),
        utilities=utilities,
        utility=utility,
        use=_numbers(use, constraints),
        kinds=_kinds(problem.streams),
        delay=delay,
        share=share,
        traffic_sent=np.array(traffic_sent, dtype=np.float64),
        traffic_use=_numbers(traffic_use, constraints),
    )


def _numbers(rows: Sequence[tuple[float, ...]], width: int) -> Floats:
    """Return rows of `width` numbers each as an array: it takes half as long as to let NumPy look at the rows."""
    numbers = np.fromiter(chain.from_iterable(rows), np.float64, len(rows) * width)
    return numbers.reshape(len(rows), width)


def _kinds(streams: Sequence[Stream]) -> tuple[tuple[Aggregation | AggregationModel, list[int]], ...]:
    """Models of the caller's need not be hashable."""
    kinds: dict[int, list[int]] = {}
    for at, stream in enumerate(streams):
        kinds.setdefault(id(stream.aggregation), []).append(at)
    return tuple((streams[members[0]].aggregation, members) for members in kinds.values())


def _receivers(streams: Sequence[Stream]) -> tuple[Floats, Floats]:
    receivers = [stream.receivers for stream in streams]
    counts = list(map(len, receivers))
    known = _numbers(list(map(_RECEIVER, chain.from_iterable(receivers))), 2)
    stream = np.repeat(np.arange(len(counts)), counts)
    delay, share = np.zeros((2, len(counts), max(counts, default=1) or 1))
    place = np.arange(len(stream)) - np.searchsorted(stream, stream)
    delay[stream, place], share[stream, place] = known.T
    return delay, share
