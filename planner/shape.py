"""Refuses what is no problem at all: text for a number, None for a message. NumPy would take it, or raise its own."""

from collections.abc import Collection, Iterable
from itertools import chain
from numbers import Integral, Real

import numpy as np

from planner.errors import ProblemError
from planner.problem import Constraint, Message, Problem, Receiver, Stream, Traffic

_PLAIN: dict[type, set[type]] = {Integral: {int}, Real: {int, float}, np.bool_: {bool}}
"""What numbers usually are: to look at types takes a fraction of what it takes to look at each number."""
_WORDS: dict[type, str] = {Integral: "a whole number", Real: "a number", np.bool_: "True or False"}
_MESSAGE: tuple[tuple[str, type], ...] = (
    ("stream", Integral),
    ("t_gen", Real),
    ("t_sent", Real),
    ("t_rcv", Real),
    ("scale", Real),
    ("sent", np.bool_),
)
_AT = [Message._fields.index(name) for name, _ in _MESSAGE]


def check_shape(problem: Problem) -> None:
    """Raise ProblemError unless the problem consists of messages, streams and numbers where it should."""
    for name, kind in (("streams", Stream), ("messages", Message), ("constraints", Constraint), ("traffic", Traffic)):
        _require_all(name, getattr(problem, name), kind)
    _require("current", (problem.current,), Integral)
    _require("t_start", (problem.t_start,), Real)
    _require("t_end", (problem.t_end,), Real)
    for index, constraint in enumerate(problem.constraints):
        _require(f"constraint {index}: window", (constraint.window,), Real)
        _require(f"constraint {index}: limit", (constraint.limit,), Real)
    _check_streams(problem.streams)
    _check_messages(problem.messages)
    _require_each("traffic {}: t_sent", [t.t_sent for t in problem.traffic], Real)
    _require_uses("traffic", [t.use for t in problem.traffic])


def _check_streams(streams: tuple[Stream, ...]) -> None:
    _require_each("stream {}: robot", [stream.robot for stream in streams], Integral)
    for index, stream in enumerate(streams):
        _require_all(f"stream {index}: receivers", stream.receivers, Receiver)
    of = [index for index, stream in enumerate(streams) for _ in stream.receivers]
    receivers = list(chain.from_iterable([stream.receivers for stream in streams]))
    _require_each("stream {}: a receiver's delay", [receiver.delay for receiver in receivers], Real, of)
    _require_each("stream {}: a receiver's share", [receiver.share for receiver in receivers], Real, of)


def _check_messages(messages: tuple[Message, ...]) -> None:
    columns = list(zip(*messages, strict=True)) if messages else [()] * len(Message._fields)
    for (name, kind), at in zip(_MESSAGE, _AT, strict=True):
        _require_each(f"message {{}}: {name}", columns[at], kind)
    _require_uses("message", columns[Message._fields.index("use")])
    utilities = columns[Message._fields.index("utility")]
    if lacking := {kind for kind in set(map(type, utilities)) if not callable(getattr(kind, "integral", None))}:
        index = next(at for at, utility in enumerate(utilities) if type(utility) in lacking)
        raise ProblemError(f"message {index}: utility must have the method integral, not be {utilities[index]!r}")


def _require_all(name: str, values: object, kind: type) -> None:
    if not isinstance(values, tuple | list):
        raise ProblemError(f"{name} must be a tuple of {kind.__name__}, not {values!r}")
    for index, value in enumerate(values):
        if not isinstance(value, kind):
            raise ProblemError(f"{name} must hold only {kind.__name__}, not {value!r} (the one with index {index})")


def _require_uses(what: str, uses: Collection[tuple[float, ...]]) -> None:
    if not set(map(type, uses)) <= {tuple, list}:
        index, use = next((at, use) for at, use in enumerate(uses) if not isinstance(use, tuple | list))
        raise ProblemError(f"{what} {index}: use must be a tuple of numbers, not {use!r}")
    if not set(map(type, chain.from_iterable(uses))) <= _PLAIN[Real]:
        for index, use in enumerate(uses):
            _require(f"{what} {index}: use", use, Real)


def _require_each(name: str, values: Collection[object], kind: type, of: Iterable[int] | None = None) -> None:
    """Require it of many values; that at place i is the one of `of[i]`."""
    if not set(map(type, values)) <= _PLAIN[kind]:
        for index, value in zip(range(len(values)) if of is None else of, values, strict=True):
            _require(name.format(index), (value,), kind)


def _require(name: str, values: Iterable[object], kind: type) -> None:
    plain = _PLAIN[kind]
    for value in values:
        if type(value) not in plain and not isinstance(value, kind):
            raise ProblemError(f"{name} must be {_WORDS[kind]}, not {value!r}")
