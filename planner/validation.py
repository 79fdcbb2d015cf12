"""Refuses problems and settings that have no meaning, naming what is wrong and where."""

import math

import numpy as np

from planner.errors import ProblemError, SearchError
from planner.problem import Aggregation, AggregationModel, Message, Problem
from planner.search import SearchSettings
from planner.utility import Floats

MAX_MESSAGES = 16_384
"""More messages than any decision can weigh; a window beyond it is a mistake of the caller."""


def check_settings(settings: SearchSettings) -> None:
    """Raise SearchError for settings that no engine can follow."""
    choices = (
        ("search", settings.search, ("best", "paper")),
        ("engine", settings.engine, ("native", "python")),
        ("reduction", settings.reduction, ("off", "paper", "exact")),
    )
    for name, value, known in choices:
        if value not in known:
            raise SearchError(f"{name} must be one of {', '.join(known)}, not {value!r}")
    if not (math.isfinite(settings.exploration) and settings.exploration >= 0):
        raise SearchError(f"exploration must be a finite number >= 0, not {settings.exploration}")
    if not 1 <= settings.max_nodes <= 2**24:
        raise SearchError(f"max_nodes must be between 1 and {2**24:,}, not {settings.max_nodes}")


def check_problem(problem: Problem) -> None:
    """Raise ProblemError for a problem that has no meaning."""
    _check_shape(problem)
    _check_constraints(problem)
    _check_streams(problem)
    _check_messages(problem)
    _check_traffic(problem)


def _check_shape(problem: Problem) -> None:
    count = len(problem.messages)
    if count == 0:
        raise ProblemError("the window holds no message: there is nothing to decide")
    if count > MAX_MESSAGES:
        raise ProblemError(f"the window holds {count:,} messages, at most {MAX_MESSAGES:,} can be weighed")
    if not 0 <= problem.current < count:
        raise ProblemError(f"current is message {problem.current}, but the window holds messages 0 to {count - 1}")
    if problem.messages[problem.current].sent:
        raise ProblemError(f"message {problem.current} is current and already sent: it cannot be decided")
    if not (math.isfinite(problem.t_start) and math.isfinite(problem.t_end) and problem.t_start < problem.t_end):
        raise ProblemError(f"t_start must lie before t_end, not {problem.t_start} and {problem.t_end}")


def _check_constraints(problem: Problem) -> None:
    for constraint in problem.constraints:
        if not (math.isfinite(constraint.window) and constraint.window > 0):
            raise ProblemError(f'constraint "{constraint.name}": window must be > 0 s, not {constraint.window}')
        if not (math.isfinite(constraint.limit) and constraint.limit >= 0):
            raise ProblemError(f'constraint "{constraint.name}": limit must be >= 0, not {constraint.limit}')


def _check_streams(problem: Problem) -> None:
    for index, stream in enumerate(problem.streams):
        if not isinstance(stream.aggregation, Aggregation | AggregationModel):
            raise ProblemError(
                f"stream {index}: aggregation must be one of {', '.join(Aggregation)} or have the methods empty, add"
                f" and value, not {stream.aggregation!r}"
            )
        for receiver in stream.receivers:
            if not (math.isfinite(receiver.delay) and receiver.delay >= 0):
                raise ProblemError(f"stream {index}: a receiver's delay must be >= 0 s, not {receiver.delay}")
            if not (math.isfinite(receiver.share) and receiver.share >= 0):
                raise ProblemError(f"stream {index}: a receiver's share must be >= 0, not {receiver.share}")


def _check_messages(problem: Problem) -> None:
    count = len(problem.streams)
    for index, message in enumerate(problem.messages):
        if not 0 <= message.stream < count:
            raise ProblemError(f"message {index}: stream {message.stream} is unknown, there are {count}")
    times = np.array([(m.t_gen, m.t_sent, m.t_rcv, m.scale) for m in problem.messages], dtype=np.float64)
    uses = _uses(problem, [m.use for m in problem.messages], "message")
    ordered = (times[:, 0] <= times[:, 1]) & (times[:, 1] <= times[:, 2]) & (times[:, 3] >= 0)
    if not (np.isfinite(times).all() and ordered.all()):
        _refuse_first(problem.messages)
    _check_numbers(uses, "message")
    _check_order(problem)


def _refuse_first(messages: tuple[Message, ...]) -> None:
    for index, m in enumerate(messages):
        if not all(math.isfinite(number) for number in (m.t_gen, m.t_sent, m.t_rcv)):
            raise ProblemError(f"message {index}: times must be finite, not {m.t_gen}, {m.t_sent}, {m.t_rcv}")
        if not m.t_gen <= m.t_sent <= m.t_rcv:
            raise ProblemError(
                f"message {index}: times out of order: t_gen {m.t_gen}, t_sent {m.t_sent}, t_rcv {m.t_rcv}"
            )
        if not (math.isfinite(m.scale) and m.scale >= 0):
            raise ProblemError(f"message {index}: scale must be a finite number >= 0, not {m.scale}")


def _check_order(problem: Problem) -> None:
    robots = [stream.robot for stream in problem.streams]
    keys = [(m.t_gen, robots[m.stream], m.stream) for m in problem.messages]
    for index in range(1, len(keys)):
        if keys[index] < keys[index - 1]:
            raise ProblemError(f"message {index} belongs before {index - 1}: order by t_gen, then robot, then stream")
    sent = -math.inf
    received: dict[int, float] = {}
    for index, m in enumerate(problem.messages):
        if m.sent:
            continue
        if m.t_sent < sent:
            raise ProblemError(f"message {index}: t_sent of the open messages must not decrease")
        if m.t_rcv < received.get(m.stream, -math.inf):
            raise ProblemError(f"message {index}: open messages of stream {m.stream} are received out of order")
        sent = m.t_sent
        received[m.stream] = m.t_rcv


def _check_traffic(problem: Problem) -> None:
    if not problem.traffic:
        return
    for index, traffic in enumerate(problem.traffic):
        if not math.isfinite(traffic.t_sent):
            raise ProblemError(f"traffic {index}: t_sent must be finite, not {traffic.t_sent}")
    _check_numbers(_uses(problem, [t.use for t in problem.traffic], "traffic"), "traffic")


def _uses(problem: Problem, uses: list[tuple[float, ...]], what: str) -> Floats:
    wanted = len(problem.constraints)
    for index, use in enumerate(uses):
        if len(use) != wanted:
            raise ProblemError(f"{what} {index}: use has {len(use)} entries for {wanted} constraints")
    return np.array(uses, dtype=np.float64).reshape(len(uses), wanted)


def _check_numbers(uses: Floats, what: str) -> None:
    wrong = ~(np.isfinite(uses) & (uses >= 0)).all(axis=1)
    if wrong.any():
        index = int(np.argmax(wrong))
        raise ProblemError(f"{what} {index}: use must be finite and >= 0, not {tuple(uses[index].tolist())}")
