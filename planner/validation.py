"""Refuses problems and settings that have no meaning, naming what is wrong and where."""

import numpy as np

from planner.errors import ProblemError, SearchError
from planner.finite import finite
from planner.problem import Aggregation, AggregationModel, Message, Problem
from planner.search import SearchSettings
from planner.shape import check_shape
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
    if not (finite(settings.exploration) and settings.exploration >= 0):
        raise SearchError(f"exploration must be a finite number >= 0, not {settings.exploration!r}")
    if not (isinstance(settings.max_nodes, int) and 1 <= settings.max_nodes <= 2**24):
        raise SearchError(f"max_nodes must be a whole number from 1 to {2**24:,}, not {settings.max_nodes!r}")


def check_problem(problem: Problem) -> None:
    """Raise ProblemError for a problem that has no meaning."""
    check_shape(problem)
    _check_window(problem)
    _check_constraints(problem)
    _check_uses(problem)
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


def _check_streams(problem: Problem) -> None:
    try:
        columns = problem.columns
    except OverflowError as error:
        raise ProblemError(f"the window holds a number that is too large: {error}") from error
    for kind, members in columns.kinds:
        if not isinstance(kind, Aggregation | AggregationModel):
            raise ProblemError(
                f"stream {members[0]}: aggregation must be one of {', '.join(Aggregation)} or have the methods empty,"
                f" add and value, not {kind!r}"
            )
    delay, share = columns.delay, columns.share
    if not (np.isfinite(delay) & (delay >= 0) & np.isfinite(share) & (share >= 0)).all():
        _refuse_receiver(problem)


def _refuse_receiver(problem: Problem) -> None:
    for index, stream in enumerate(problem.streams):
        for receiver in stream.receivers:
            if not (finite(receiver.delay) and receiver.delay >= 0):
                raise ProblemError(f"stream {index}: a receiver's delay must be >= 0 s, not {receiver.delay}")
            if not (finite(receiver.share) and receiver.share >= 0):
                raise ProblemError(f"stream {index}: a receiver's share must be >= 0, not {receiver.share}")


def _check_messages(problem: Problem) -> None:
    columns, count = problem.columns, len(problem.streams)
    unknown = (columns.stream < 0) | (columns.stream >= count)
    if unknown.any():
        index = int(np.argmax(unknown))
        raise ProblemError(f"message {index}: stream {columns.stream[index]} is unknown, there are {count}")
    times, scale = columns.times, columns.scale
    ordered = (times[:-1] <= times[1:]).all() and np.isfinite(times).all()
    if not (ordered and np.isfinite(scale).all() and scale.min() >= 0):
        _refuse_first(problem.messages)
    _check_numbers(columns.use, "message")
    _check_order(problem)


def _refuse_first(messages: tuple[Message, ...]) -> None:
    for index, m in enumerate(messages):
        if not all(finite(number) for number in (m.t_gen, m.t_sent, m.t_rcv)):
            raise ProblemError(f"message {index}: times must be finite, not {m.t_gen}, {m.t_sent}, {m.t_rcv}")
        if not m.t_gen <= m.t_sent <= m.t_rcv:
            raise ProblemError(
                f"message {index}: times out of order: t_gen {m.t_gen}, t_sent {m.t_sent}, t_rcv {m.t_rcv}"
            )
        if not (finite(m.scale) and m.scale >= 0):
            raise ProblemError(f"message {index}: scale must be a finite number >= 0, not {m.scale}")


def _check_order(problem: Problem) -> None:
    columns = problem.columns
    robot = np.array([stream.robot for stream in problem.streams])[columns.stream]
    order = np.lexsort((columns.stream, robot, columns.t_gen))
    if (order[1:] < order[:-1]).any():
        keys = list(zip(columns.t_gen, robot, columns.stream, strict=True))
        index = next(at for at in range(1, len(keys)) if keys[at] < keys[at - 1])
        raise ProblemError(f"message {index} belongs before {index - 1}: order by t_gen, then robot, then stream")
    _check_receipts(problem)


def _check_receipts(problem: Problem) -> None:
    columns = problem.columns
    opened = columns.opened
    earlier = np.diff(columns.t_sent[opened]) < 0
    by_stream = opened[np.argsort(columns.stream[opened], kind="stable")]
    overtakes = (np.diff(columns.t_rcv[by_stream]) < 0) & (np.diff(columns.stream[by_stream]) == 0)
    if earlier.any():
        index = int(opened[1:][np.argmax(earlier)])
        raise ProblemError(f"message {index}: t_sent of the open messages must not decrease")
    if overtakes.any():
        index = int(by_stream[1:][np.argmax(overtakes)])
        stream = columns.stream[index]
        raise ProblemError(f"message {index}: open messages of stream {stream} are received out of order")


def _check_traffic(problem: Problem) -> None:
    lost = ~np.isfinite(problem.columns.traffic_sent)
    if lost.any():
        index = int(np.argmax(lost))
        raise ProblemError(f"traffic {index}: t_sent must be finite, not {problem.traffic[index].t_sent}")
    _check_numbers(problem.columns.traffic_use, "traffic")


def _check_uses(problem: Problem) -> None:
    wanted = len(problem.constraints)
    messages, traffic = [m.use for m in problem.messages], [t.use for t in problem.traffic]
    for what, uses in (("message", messages), ("traffic", traffic)):
        if set(map(len, uses)) - {wanted}:
            index = next(at for at, use in enumerate(uses) if len(use) != wanted)
            raise ProblemError(f"{what} {index}: use has {len(uses[index])} entries for {wanted} constraints")


def _check_numbers(uses: Floats, what: str) -> None:
    if not (np.isfinite(uses).all() and (uses >= 0).all()):
        index = int(np.argmin((np.isfinite(uses) & (uses >= 0)).all(axis=1)))
        raise ProblemError(f"{what} {index}: use must be finite and >= 0, not {tuple(uses[index].tolist())}")
