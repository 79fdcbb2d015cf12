"""Refuses what is no problem at all: text for a number, None for a message. NumPy would take it, or raise its own."""

from collections.abc import Iterable
from numbers import Integral, Real

import numpy as np

from planner.errors import ProblemError
from planner.problem import Constraint, Message, Problem, Receiver, Stream, Traffic

_WORDS: dict[type, str] = {Integral: "a whole number", Real: "a number", np.bool_: "True or False"}
_FLAG = (bool, np.bool_)
_MESSAGE: tuple[tuple[str, type], ...] = (
    ("stream", Integral),
    ("t_gen", Real),
    ("t_sent", Real),
    ("t_rcv", Real),
    ("scale", Real),
    ("sent", np.bool_),
)


def check_shape(problem: Problem) -> None:
    """Raise ProblemError unless the problem consists of messages, streams and numbers where it should."""
    for name, kind in (("streams", Stream), ("messages", Message), ("constraints", Constraint), ("traffic", Traffic)):
        _require_all(name, getattr(problem, name), kind)
    _require("current", problem.current, Integral)
    _require("t_start", problem.t_start, Real)
    _require("t_end", problem.t_end, Real)
    for index, constraint in enumerate(problem.constraints):
        _require(f"constraint {index}: window", constraint.window, Real)
        _require(f"constraint {index}: limit", constraint.limit, Real)
    for index, stream in enumerate(problem.streams):
        _check_stream(f"stream {index}", stream)
    for index, message in enumerate(problem.messages):
        _check_message(f"message {index}", message)
    for index, traffic in enumerate(problem.traffic):
        _require(f"traffic {index}: t_sent", traffic.t_sent, Real)
        _require_use(f"traffic {index}", traffic.use)


def _check_stream(name: str, stream: Stream) -> None:
    _require(f"{name}: robot", stream.robot, Integral)
    _require_all(f"{name}: receivers", stream.receivers, Receiver)
    for receiver in stream.receivers:
        _require(f"{name}: a receiver's delay", receiver.delay, Real)
        _require(f"{name}: a receiver's share", receiver.share, Real)
    if stream.newest is not None:
        if not (isinstance(stream.newest, tuple) and len(stream.newest) == 2):
            raise ProblemError(f"{name}: newest must be a time and a scale, or None, not {stream.newest!r}")
        for number in stream.newest:
            _require(f"{name}: newest", number, Real)


def _check_message(name: str, message: Message) -> None:
    for field, kind in _MESSAGE:
        _require(f"{name}: {field}", getattr(message, field), kind)
    _require_use(name, message.use)
    if not callable(getattr(type(message.utility), "integral", None)):
        raise ProblemError(f"{name}: utility must have the method integral, not be {message.utility!r}")


def _require_all(name: str, values: object, kind: type) -> None:
    if not isinstance(values, tuple | list):
        raise ProblemError(f"{name} must be a tuple of {kind.__name__}, not {values!r}")
    for index, value in enumerate(values):
        if not isinstance(value, kind):
            raise ProblemError(f"{name} must hold only {kind.__name__}, not {value!r} (the one with index {index})")


def _require_use(name: str, use: Iterable[object]) -> None:
    if not isinstance(use, tuple | list):
        raise ProblemError(f"{name}: use must be a tuple of numbers, not {use!r}")
    for value in use:
        _require(f"{name}: use", value, Real)


def _require(name: str, value: object, kind: type) -> None:
    if not isinstance(value, _FLAG if kind is np.bool_ else kind):
        raise ProblemError(f"{name} must be {_WORDS[kind]}, not {value!r}")
