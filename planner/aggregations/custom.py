"""An aggregation of the caller's own: its states are interned as they come up, set by set of sent messages.

The table holds every state of a stream as long as there are at most `MAX_STATES`. A stream that has more is *open
ended*: beyond them the table forgets all but the newest message, and is a guide only; what its plans are really worth
is worked out along the path, in the Python engine.
"""

import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import TypeVar, cast

import numpy as np

from planner.aggregations.part import Part
from planner.errors import ProblemError
from planner.problem import AggregationModel, Message, Problem
from planner.utility import Floats

MAX_STATES = 128
"""States of a stream in the table; each costs several calls of the model at every later message."""

Result = TypeVar("Result")

States = tuple[Hashable, ...]
"""What was received, for each end (U's and that of what the search maximises) and receiver: the model's states."""


class CustomStream:
    """The messages of one stream under the caller's model, as an automaton that grows on demand.

    `until` is when the utility ends for what the search maximises, at t_end or later [s].
    """

    def __init__(self, problem: Problem, stream: int, levels: list[int], until: float) -> None:
        self._model = Guarded(stream, cast("AggregationModel", problem.streams[stream].aggregation))
        self._ends = (problem.t_end, until)
        self._receivers = problem.streams[stream].receivers
        order = [i for i, m in enumerate(problem.messages) if m.stream == stream]
        order.sort(key=lambda i: problem.messages[i].t_rcv)
        self._messages = [problem.messages[i] for i in order]
        self._place: dict[int, int] = {}
        opened = iter(levels)
        for place, message in enumerate(self._messages):
            if not message.sent:
                self._place[next(opened)] = place
        self._worths: dict[tuple[States, int], tuple[float, float]] = {}

    def empty(self) -> States:
        """Return the state before anything was received."""
        state = self._model.empty()
        return (state,) * (len(self._ends) * len(self._receivers))

    def place(self, level: int) -> int:
        """Return the place of the message of a level."""
        return self._place[level]

    def arrive(self, states: States, begin: int, end: int) -> States:
        """Add the facts at the places from `begin` to before `end`."""
        for place in range(begin, end):
            if self._messages[place].sent:
                states = self.add(states, place)
        return states

    def worth(self, states: States, place: int) -> tuple[float, float]:
        """Return what a state is worth if from `place` on only facts are received: U and what is maximised."""
        key = (states, place)
        if key in self._worths:
            return self._worths[key]
        final = self.arrive(states, place, len(self._messages))
        each = iter(final)
        totals = [
            sum(receiver.share * self._model.value(next(each), end) for receiver in self._receivers)
            for end in self._ends
        ]
        worth = self._worths[key] = (totals[0], totals[1])
        return worth

    def add(self, states: States, place: int) -> States:
        """Add the message at a place; what arrives after an end does not count up to it."""
        each, added = iter(states), []
        for end in self._ends:
            for receiver in self._receivers:
                state, message = next(each), self._messages[place]
                arrived = message._replace(t_rcv=message.t_rcv + receiver.delay)
                added.append(self._model.add(state, arrived) if arrived.t_rcv < end else state)
        return tuple(added)

    def everything(self) -> float:
        """Return U when all messages are received [utility·s]."""
        states = self.empty()
        for place in range(len(self._messages)):
            states = self.add(states, place)
        return self.worth(states, len(self._messages))[0]


@dataclass(slots=True)
class _Grown:
    """What the walk from receipt to receipt collects."""

    states: list[States]
    after: list[int] = field(default_factory=list)
    gain: list[float] = field(default_factory=list)
    aim: list[float] = field(default_factory=list)
    widths: list[int] = field(default_factory=list)
    closed: bool = True


def tabulate(problem: Problem, stream: int, levels: list[int], until: float) -> tuple[Part, CustomStream | None]:
    """Return the table of one stream, and the stream itself when it has more states than the table holds.

    Raises ProblemError when the model fails.
    """
    custom = CustomStream(problem, stream, levels, until)
    grown, begin = _Grown([custom.empty()]), 0
    for level in levels:
        place = custom.place(level)
        grown.states = [custom.arrive(states, begin, place) for states in grown.states]
        _decide(custom, grown, place)
        begin = place + 1
    facts = custom.worth(custom.empty(), 0)
    part = Part(
        level=np.array(levels, dtype=np.int64),
        states=np.array(grown.widths, dtype=np.int64),
        after=np.array(grown.after, dtype=np.int64),
        gain=np.array(grown.gain, dtype=np.float64),
        aim=np.array(grown.aim, dtype=np.float64),
        facts=facts[0],
        aim_facts=facts[1],
        everything=custom.everything(),
    )
    return part, None if grown.closed else custom


def alone(problem: Problem, stream: int, message: Message, spans: Floats) -> Floats:
    """Return what a message is worth `spans` [s] after its receipt when nothing else is received [utility·s]."""
    model = Guarded(stream, cast("AggregationModel", problem.streams[stream].aggregation))
    state = model.add(model.empty(), message)
    share = sum(receiver.share for receiver in problem.streams[stream].receivers)
    return share * np.array([model.value(state, message.t_rcv + span) for span in spans.tolist()])


def _decide(custom: CustomStream, grown: _Grown, place: int) -> None:
    """Add the entries of the open message at a place, one for each state, and the states that sending leads to."""
    known = {states: number for number, states in reversed(list(enumerate(grown.states)))}
    width = len(grown.states)
    for number in range(width):
        before = grown.states[number]
        sent = custom.add(before, place)
        more = zip(custom.worth(sent, place + 1), custom.worth(before, place + 1), strict=True)
        gain, aim = (with_it - without for with_it, without in more)
        if sent not in known and len(grown.states) >= MAX_STATES:
            grown.closed = False
            sent = custom.add(custom.arrive(custom.empty(), 0, place), place)
        if sent not in known:
            known[sent] = len(grown.states)
            grown.states.append(sent)
        grown.after.append(known[sent])
        grown.gain.append(gain)
        grown.aim.append(aim)
    grown.widths.append(width)


@dataclass(frozen=True, slots=True)
class Guarded:
    """The caller's model, whose every failure becomes a ProblemError that names it."""

    stream: int
    model: AggregationModel

    def empty(self) -> Hashable:
        """Return the state of nothing received."""
        return self._hashable("empty", self._call("empty", self.model.empty))

    def add(self, state: Hashable, message: Message) -> Hashable:
        """Return the state with a message."""
        return self._hashable("add", self._call("add", lambda: self.model.add(state, message)))

    def value(self, state: Hashable, t_end: float) -> float:
        """Return what a state is worth."""
        value = self._call("value", lambda: float(self.model.value(state, t_end)))
        if not math.isfinite(value):
            raise ProblemError(f"{self._name('value')} returned {value}: it must be finite [utility·s]")
        return value

    def _call(self, name: str, call: Callable[[], Result]) -> Result:
        try:
            return call()
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            raise ProblemError(f"{self._name(name)} failed: {type(error).__name__}: {error}") from error

    def _hashable(self, name: str, state: Hashable) -> Hashable:
        try:
            hash(state)
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            kind = type(state).__name__
            raise ProblemError(f"{self._name(name)} returned a {kind}: states must be hashable") from error
        return state

    def _name(self, method: str) -> str:
        return f"stream {self.stream}: aggregation {type(self.model).__name__}.{method}()"
