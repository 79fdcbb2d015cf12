"""Refuses problems that have no meaning, naming what is wrong and where."""

import math

from planner.errors import ProblemError
from planner.excess import initial
from planner.finite import finite
from planner.problem import Aggregation, AggregationModel, Message, Problem, Stream
from planner.shape import check_shape

MAX_MESSAGES = 16_384
"""More messages than any decision can weigh; a window beyond it is a mistake of the caller."""


def check_problem(problem: Problem) -> None:
    """Raise ProblemError for a problem that has no meaning."""
    check_shape(problem)
    _check_window(problem)
    _check_constraints(problem)
    _check_columns(problem)
    _check_streams(problem)
    _check_messages(problem)
    _check_traffic(problem)


def _check_window(problem: Problem) -> None:
    count = len(problem.messages)
    if count == 0:
        raise ProblemError("the window holds no message: there is nothing to decide")
    if count > MAX_MESSAGES:
        raise ProblemError(f"the window holds {count:,} messages, at most {MAX_MESSAGES:,} can be weighed")
    if not 0 <= problem.current < count:
        raise ProblemError(f"current is message {problem.current}, but the window holds messages 0 to {count - 1}")
    if problem.messages[problem.current].sent:
        raise ProblemError(f"message {problem.current} is current and already sent: it cannot be decided")
    if not (finite(problem.t_start) and finite(problem.t_end) and problem.t_start < problem.t_end):
        raise ProblemError(f"t_start must lie before t_end, not {problem.t_start} and {problem.t_end}")


def _check_constraints(problem: Problem) -> None:
    for constraint in problem.constraints:
        if not (finite(constraint.window) and constraint.window > 0):
            raise ProblemError(f'constraint "{constraint.name}": window must be > 0 s, not {constraint.window}')
        if not (finite(constraint.limit) and constraint.limit >= 0):
            raise ProblemError(f'constraint "{constraint.name}": limit must be >= 0, not {constraint.limit}')


def _check_columns(problem: Problem) -> None:
    """Raise ProblemError unless all numbers fit into arrays."""
    wanted, messages, traffic = len(problem.constraints), problem.messages, problem.traffic
    for what, uses in (("message", [m.use for m in messages]), ("traffic", [t.use for t in traffic])):
        for index, use in enumerate(uses):
            if len(use) != wanted:
                raise ProblemError(f"{what} {index}: use has {len(use)} entries for {wanted} constraints")
    try:
        _ = problem.columns
    except OverflowError as error:
        raise ProblemError(f"the window holds a number that is too large: {error}") from error


def _check_streams(problem: Problem) -> None:
    for index, stream in enumerate(problem.streams):
        if not isinstance(stream.aggregation, Aggregation | AggregationModel):
            raise ProblemError(
                f"stream {index}: aggregation must be one of {', '.join(Aggregation)} or have the methods empty,"
                f" add and value, not {stream.aggregation!r}"
            )
        _check_newest(index, stream)
        for receiver in stream.receivers:
            if not (finite(receiver.delay) and receiver.delay >= 0):
                raise ProblemError(f"stream {index}: a receiver's delay must be >= 0 s, not {receiver.delay}")
            if not (finite(receiver.share) and receiver.share >= 0):
                raise ProblemError(f"stream {index}: a receiver's share must be >= 0, not {receiver.share}")


def _check_newest(index: int, stream: Stream) -> None:
    if stream.newest is None:
        return
    t_gen, scale = stream.newest
    if not (finite(t_gen) and finite(scale) and scale >= 0):
        raise ProblemError(f"stream {index}: newest must be a finite time and a scale >= 0, not {t_gen}, {scale}")


def _check_messages(problem: Problem) -> None:
    for index, m in enumerate(problem.messages):
        if not 0 <= m.stream < len(problem.streams):
            raise ProblemError(f"message {index}: stream {m.stream} is unknown, there are {len(problem.streams)}")
        if not all(finite(number) for number in (m.t_gen, m.t_sent, m.t_rcv)):
            raise ProblemError(f"message {index}: times must be finite, not {m.t_gen}, {m.t_sent}, {m.t_rcv}")
        if not m.t_gen <= m.t_sent <= m.t_rcv:
            raise ProblemError(
                f"message {index}: times out of order: t_gen {m.t_gen}, t_sent {m.t_sent}, t_rcv {m.t_rcv}"
            )
        if not (finite(m.scale) and m.scale >= 0):
            raise ProblemError(f"message {index}: scale must be a finite number >= 0, not {m.scale}")
        _check_use(f"message {index}", m.use)
        if problem.streams[m.stream].aggregation is Aggregation.CURRENT and not math.isfinite(initial(m.utility)):
            raise ProblemError(
                f"message {index}: its utility has no limit at the age 0: `current` needs one, to know what is lost"
            )
    keys = [(m.t_gen, problem.streams[m.stream].robot, m.stream) for m in problem.messages]
    for index in range(1, len(keys)):
        if keys[index] < keys[index - 1]:
            raise ProblemError(f"message {index} belongs before {index - 1}: order by t_gen, then robot, then stream")
    _check_receipts(problem)


def _check_receipts(problem: Problem) -> None:
    """Open messages are sent in order, and those of one stream received in order."""
    last: Message | None = None
    last_of: dict[int, Message] = {}
    for index, m in enumerate(problem.messages):
        if m.sent:
            continue
        if last is not None and m.t_sent < last.t_sent:
            raise ProblemError(f"message {index}: t_sent of the open messages must not decrease")
        if m.t_rcv < last_of.get(m.stream, m).t_rcv:
            raise ProblemError(f"message {index}: open messages of stream {m.stream} are received out of order")
        last = last_of[m.stream] = m


def _check_traffic(problem: Problem) -> None:
    for index, traffic in enumerate(problem.traffic):
        if not finite(traffic.t_sent):
            raise ProblemError(f"traffic {index}: t_sent must be finite, not {traffic.t_sent}")
        _check_use(f"traffic {index}", traffic.use)


def _check_use(name: str, use: tuple[float, ...]) -> None:
    if not all(finite(number) and number >= 0 for number in use):
        raise ProblemError(f"{name}: use must be finite and >= 0, not {use}")
