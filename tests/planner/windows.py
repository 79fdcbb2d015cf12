"""Random planning windows and the optimum of small ones, to test searches on."""

import functools
import itertools
import random
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from planner import (
    Aggregation,
    AggregationModel,
    Constraint,
    Latest,
    Linear,
    Message,
    Problem,
    Receiver,
    Stream,
    Traffic,
    Video,
)
from planner.beyond import look_beyond
from planner.constraints import violations
from planner.definition import utility

MARKOVIAN = (Aggregation.MOST_RECENT,)


def window(
    seed: int,
    *,
    robots: int = 4,
    horizon: int = 8,
    constraints: int = 1,
    grid: bool = False,
    goes_on: bool = True,
    aggregations: Sequence[Aggregation | AggregationModel] = MARKOVIAN,
) -> Problem:
    """Draw a window: some messages known to be sent, the current one in the midst of the rest.

    With `grid` all times, sizes and values are round numbers, so that ties and closed window edges abound. The streams
    take the `aggregations` in turn; where there are several, streams have several receivers, too.
    """
    draw = random.Random(seed)
    streams = tuple(_stream(seed, robot, aggregations) for robot in range(robots))
    past = draw.randint(0, 3)
    limits = tuple(_constraint(draw, k, grid=grid) for k in range(constraints))
    latency = 0.25 if grid else draw.uniform(0.0, 0.5)
    drawn = sorted((_generated(draw, at, robots, grid=grid), draw.randrange(robots)) for at in range(past + horizon))
    messages = []
    for at, (t_gen, stream) in enumerate(drawn):
        sent = at < past and draw.random() < 0.7
        extra = draw.choice((0.0, 0.3)) if sent else 0.0
        messages.append(
            Message(
                stream=stream,
                t_gen=t_gen,
                t_sent=t_gen + extra / 3,
                t_rcv=t_gen + latency + extra,
                utility=_utility(draw, grid=grid),
                scale=float(draw.randint(1, 3)) if grid else 10 ** draw.uniform(-1, 1) * (draw.random() > 0.05),
                use=tuple(_use(draw, grid=grid) for _ in range(constraints)),
                sent=sent,
            )
        )
    opened = [at for at, message in enumerate(messages) if not message.sent]
    traffic = tuple(
        Traffic(_generated(draw, 2, robots, grid=grid), tuple(_use(draw, grid=grid) for _ in range(constraints)))
        for _ in range(draw.choice((0, 0, 0, 1, 2)))
    )
    return Problem(
        streams=streams,
        messages=tuple(messages),
        current=draw.choice(opened[: max(1, len(opened) // 2)]),
        constraints=limits,
        traffic=traffic,
        t_start=min(messages[0].t_gen, 0.0) - 1.0,
        t_end=messages[-1].t_gen + draw.uniform(0.1, 1.5),
        goes_on=goes_on,
    )


def _stream(seed: int, robot: int, aggregations: Sequence[Aggregation | AggregationModel]) -> Stream:
    if len(aggregations) == 1:
        return Stream(robot, aggregations[0])
    draw = random.Random(1000 * seed + robot)
    receivers = tuple(
        Receiver(draw.choice((0.0, 0.1, 0.35)), draw.choice((0.5, 1.0, 2.0))) for _ in range(draw.randint(1, 3))
    )
    newest = Latest(draw.uniform(-1.0, 2.0), draw.choice((0.0, 0.5, 3.0))) if draw.random() < 0.5 else None
    return Stream(robot, aggregations[(seed + robot) % len(aggregations)], receivers, newest)


def crowded(count: int) -> Problem:
    """A stream of `best` whose messages begin and fade at random: which of them is the best changes ever again."""
    draw = random.Random(1)
    messages = tuple(
        _single(0, 0.1 * at, Linear(1.0, draw.uniform(0.1, 1.1)), scale=draw.uniform(1.0, 2.0)) for at in range(count)
    )
    return Problem((Stream(0, Aggregation.BEST),), messages, 0, (Constraint("c", 1.0, 100.0),), (), -1.0, 6.0)


def stale_window(seed: int) -> Problem:
    """Draw a window whose first message pays only once a later one replaced it.

    So paper mode looks deep below dropping it, then finds better tantamount nodes below sending it.
    """
    draw = random.Random(seed)
    messages = [_single(0, -1.0, Linear(1.0, 0.01), sent=True), _single(0, 0.0, Linear(2.0, 1.0))]
    messages.append(_single(1, 0.5, Linear(1.0, 1.0), scale=0.01))
    messages.append(_single(0, 1.0, Linear(3.0, 0.01)))
    for at in range(draw.randint(1, 6)):
        utility = Linear(draw.uniform(0.1, 3.0), draw.uniform(0.01, 1.0))
        messages.append(_single(draw.randrange(2), 1.5 + at / 2, utility))
    limit = Constraint("c", draw.choice((1.0, 1.5, 2.0)), float(draw.randint(1, 3)))
    return Problem((Stream(0), Stream(1)), tuple(messages), 1, (limit,), (), -2.0, 10.0)


def _single(stream: int, time: float, utility: Linear, *, scale: float = 1.0, sent: bool = False) -> Message:
    return Message(stream, time, time, time, utility, scale, (1.0,), sent)


def _generated(draw: random.Random, at: int, robots: int, *, grid: bool) -> float:
    spread = (at + draw.uniform(0.0, 1.5)) / robots
    return round(spread * 10) / 10 if grid else spread


def _constraint(draw: random.Random, k: int, *, grid: bool) -> Constraint:
    if grid:
        return Constraint(f"c{k}", draw.choice((0.3, 0.5, 1.0)), float(draw.randint(1, 4)))
    return Constraint(f"c{k}", draw.uniform(0.2, 1.5), draw.uniform(1.5, 5.0))


def _use(draw: random.Random, *, grid: bool) -> float:
    if draw.random() < 0.1:
        return draw.choice((0.0, 6.0))
    return float(draw.randint(1, 2)) if grid else draw.uniform(0.5, 2.5)


def _utility(draw: random.Random, *, grid: bool) -> Linear | Video:
    if grid:
        return Linear(1.0, 0.5)
    return Video(a1=draw.uniform(0.5, 10.0)) if draw.random() < 0.3 else Linear(1.0, draw.uniform(0.003, 1.5))


def open_messages(problem: Problem) -> list[int]:
    """The indices of the messages to decide."""
    return [index for index, message in enumerate(problem.messages) if not message.sent]


def utilities(problem: Problem) -> Callable[[Iterable[int]], float]:
    """U of any messages to send: that of each stream is worked out once for each set of its messages."""
    return _by_stream(problem, lambda number, chosen: _of(problem, number, chosen, problem.t_end))


def objectives(problem: Problem) -> Callable[[Iterable[int]], float]:
    """U, and what every stream leaves behind by its aggregation, less what all sent are charged beyond the window."""
    beyond = look_beyond(problem)

    def of(number: int, chosen: frozenset[int]) -> float:
        charged = float(sum(beyond.charge[i] for i in chosen))
        received = [i for i, m in enumerate(problem.messages) if m.stream == number and (m.sent or i in chosen)]
        received.sort(key=lambda i: problem.messages[i].t_rcv)
        match problem.streams[number].aggregation:
            case Aggregation.MOST_RECENT | Aggregation.CURRENT:
                left = received[-1:]
            case Aggregation.SUM:
                left = received
            case Aggregation.ONCE:
                left = received[:1]
            case _:
                return _of(problem, number, chosen, float(beyond.until[number])) - charged
        return _of(problem, number, chosen, problem.t_end) + float(sum(beyond.worth[left])) - charged

    return _by_stream(problem, of)


def objective(problem: Problem, sends: Iterable[int]) -> float:
    """The objective of one set of messages."""
    return objectives(problem)(sends)


def _by_stream(problem: Problem, of: Callable[[int, frozenset[int]], float]) -> Callable[[Iterable[int]], float]:
    """Return the sum over all streams of what each is worth by the messages of it that are sent."""
    known = functools.cache(of)
    streams = [
        frozenset(index for index, message in enumerate(problem.messages) if message.stream == number)
        for number in range(len(problem.streams))
    ]

    def total(sends: Iterable[int]) -> float:
        chosen = frozenset(sends)
        return float(sum(known(number, chosen & stream) for number, stream in enumerate(streams)))

    return total


def _of(problem: Problem, stream: int, chosen: frozenset[int], t_end: float) -> float:
    """U of one stream up to `t_end`."""
    silent = tuple(s if at == stream else s._replace(receivers=()) for at, s in enumerate(problem.streams))
    return utility(replace(problem, streams=silent, t_end=t_end), chosen)


def optimum(
    problem: Problem, values: Callable[[Problem], Callable[[Iterable[int]], float]] = utilities
) -> tuple[float, float, float]:
    """The greatest value of all subsets that fit: of all, of those with and without `current`."""
    best = {True: float("-inf"), False: float("-inf")}
    opened, value = open_messages(problem), values(problem)
    for chosen in itertools.product((False, True), repeat=len(opened)):
        sends = list(itertools.compress(opened, chosen))
        with_current = problem.current in sends
        worth = value(sends)
        if worth > best[with_current] and not violations(problem, sends):
            best[with_current] = worth
    return max(best.values()), best[True], best[False]
