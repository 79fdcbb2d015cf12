"""The evaluation model: what a set of messages is worth, as gains that a search adds up (§2.2).

U is a sum over streams, and a stream's part of it depends on which of its messages were received. The messages that
are known to be sent are fixed, and the open ones are decided in the order in which they are received. So the gain of
sending one depends only on the *state* of its stream: what matters of the open messages sent before. All gains of a
window are tabulated at once before the search starts; `aggregations/` holds how, for each aggregation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from planner.aggregations import best, current, custom, independent, most_recent, once
from planner.aggregations.part import Part, join
from planner.beyond import Beyond
from planner.errors import PlannerError, ProblemError
from planner.problem import MARKOVIAN, Aggregation, Problem
from planner.received import Received
from planner.utility import Flags, Floats, Ints


@dataclass(frozen=True, slots=True)
class Gains:
    """What sending each open message adds, by level and state of its stream.

    Level i decides the i-th open message. Only streams that have any are counted here, in the order of the problem.
    Each begins in state 0 and keeps its state when a message is dropped. At level i the stream `stream[i]` may be in
    the first `start[i + 1] − start[i]` states; sending in state s gains `gain[start[i] + s]` [utility·s] and leads to
    the state `after[start[i] + s]`.
    """

    stream: Ints
    start: Ints
    after: Ints
    gain: Floats
    facts: float
    """U of the messages that are known to be sent [utility·s]."""
    everything: float
    """U(M) of Eq. 2: all messages of the window received; of `current` without what is lost [utility·s]."""
    aim: Floats
    """What each of the gains adds to what the search maximises: U, or the objective of beyond.py [utility·s]."""
    aim_facts: float
    """The same of the facts alone [utility·s]."""
    exact: bool
    """Whether the table says what plans are worth; if not, it is close, and nothing is proven by it."""
    markovian: Flags
    """By stream: whether the message received last is all that counts."""
    open_ended: tuple[custom.CustomStream | None, ...]
    """By stream: what works out the gains of one with more states than the table holds; None for all others."""

    @property
    def closed(self) -> bool:
        """Whether the table holds all there is to know."""
        return self.open_ended.count(None) == len(self.open_ended)


def tabulate_gains(problem: Problem, beyond: Beyond | None = None) -> Gains:
    """Tabulate all gains of a valid problem, to maximise U or what is left `beyond` the window, too.

    Raises ProblemError when they are too many or not finite, or when an aggregation of the caller fails.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        gains = _Tabulation(problem, beyond).gains()
    numbers = (gains.gain, gains.aim, gains.everything, gains.facts, gains.aim_facts)
    if not all(np.isfinite(number).all() for number in numbers):
        raise ProblemError("the utility of the window is not finite: scale or utility parameters are too large")
    return gains


Standard: TypeAlias = "Callable[[Received, Floats | None], Part]"

BY_WORTH: dict[Aggregation, Standard] = {
    Aggregation.MOST_RECENT: most_recent.tabulate,
    Aggregation.SUM: independent.tabulate,
    Aggregation.ONCE: once.tabulate,
    Aggregation.CURRENT: current.tabulate,
}
"""The aggregations whose messages leave behind what each is worth beyond the window."""


class _Tabulation:
    """The tables of all streams, aggregation by aggregation."""

    def __init__(self, problem: Problem, beyond: Beyond | None) -> None:
        self._problem = problem
        self._beyond = beyond
        self._stream = problem.columns.stream
        self._opened = problem.columns.opened
        self._open_ended: dict[int, custom.CustomStream] = {}

    def gains(self) -> Gains:
        """Join the tables."""
        problem, beyond = self._problem, self._beyond
        part = join(list(self._parts()))
        aim = part.aim
        if beyond is not None:
            aim = aim - np.repeat(beyond.charge[self._opened], part.states)
        of = self._stream[self._opened]
        present = np.bincount(of, minlength=len(problem.streams)) > 0
        streams, stream = np.flatnonzero(present), (np.cumsum(present) - 1)[of]
        markovian = np.zeros(len(problem.streams), dtype=np.bool_)
        for kind, members in problem.columns.kinds:
            markovian[members] = isinstance(kind, Aggregation) and kind in MARKOVIAN
        return Gains(
            stream=stream,
            start=np.concatenate(([0], np.cumsum(part.states))),
            after=part.after,
            gain=part.gain,
            facts=part.facts,
            everything=part.everything,
            aim=aim,
            aim_facts=part.aim_facts,
            exact=part.exact,
            markovian=markovian[streams],
            open_ended=tuple(map(self._open_ended.get, streams.tolist())),
        )

    def _parts(self) -> Iterator[Part]:
        """Yield the table of each aggregation that has messages."""
        worth, until = (None, None) if self._beyond is None else (self._beyond.worth, self._beyond.until)
        for kind, streams in self._problem.columns.kinds:
            if not isinstance(kind, Aggregation):
                for stream in streams:
                    if (self._stream == stream).any():
                        yield self._custom(stream, self._problem.t_end if until is None else float(until[stream]))
            elif (received := self._received(streams)) is not None:
                known = BY_WORTH.get(kind)
                yield best.tabulate(received, until) if known is None else known(received, worth)

    def _received(self, streams: list[int]) -> Received | None:
        members = np.isin(self._stream, streams)
        if not members.any():
            return None
        return Received(self._problem, np.flatnonzero(members), np.flatnonzero(members[self._opened]))

    def _custom(self, stream: int, until: float) -> Part:
        levels = np.flatnonzero(self._stream[self._opened] == stream).tolist()
        try:
            part, open_ended = custom.tabulate(self._problem, stream, levels, until)
        except PlannerError:
            raise
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # states of the caller's may fail when they are compared
            raise ProblemError(f"stream {stream}: its states failed: {type(error).__name__}: {error}") from error
        if open_ended is not None:
            self._open_ended[stream] = open_ended
        return part
