"""U of a plan by the definition (§2.2), message by message: what the tables of a search must add up to."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from planner.aggregations.custom import Guarded
from planner.problem import Aggregation, AggregationModel, Message, Problem

CELLS = 4_000
"""Into so many pieces the time of a stream is cut to integrate the best of its messages."""


def utility(problem: Problem, sends: Iterable[int]) -> float:
    """U of the facts and the open messages `sends` up to t_end [utility·s]."""
    chosen = set(sends)
    total = 0.0
    for number in sorted({m.stream for m in problem.messages}):
        stream = problem.streams[number]
        received = [m for i, m in enumerate(problem.messages) if m.stream == number and (m.sent or i in chosen)]
        received.sort(key=lambda m: m.t_rcv)
        for receiver in stream.receivers:
            arrived = [m._replace(t_rcv=m.t_rcv + receiver.delay) for m in received]
            before_end = [m for m in arrived if m.t_rcv < problem.t_end]
            total += receiver.share * _aggregated(stream.aggregation, before_end, problem.t_end)
    return total


def _aggregated(aggregation: Aggregation | AggregationModel, received: Sequence[Message], t_end: float) -> float:
    """Return what messages in the order of receipt are worth to one receiver."""
    if isinstance(aggregation, Aggregation):
        return STANDARD[aggregation](received, t_end) if received else 0.0
    model = Guarded(received[0].stream if received else 0, aggregation)
    state = model.empty()
    for message in received:
        state = model.add(state, message)
    return model.value(state, t_end)


def _most_recent(received: Sequence[Message], t_end: float) -> float:
    ends = [*(m.t_rcv for m in received[1:]), t_end]
    return sum(_worth(m, m.t_rcv, end) for m, end in zip(received, ends, strict=True))


def _best(received: Sequence[Message], t_end: float) -> float:
    receipts = [m.t_rcv for m in received]
    edges = np.unique(np.concatenate((receipts, np.linspace(receipts[0], t_end, CELLS + 1))))
    best = np.zeros(len(edges) - 1)
    for m in received:
        ages = np.maximum(edges - m.t_gen, 0.0)
        area = m.scale * m.utility.integral(ages[:-1], ages[1:])
        best = np.maximum(best, np.where(edges[:-1] >= m.t_rcv, area, 0.0))
    return float(best.sum())


def _sum(received: Sequence[Message], t_end: float) -> float:
    return sum(_worth(m, m.t_rcv, t_end) for m in received)


def _once(received: Sequence[Message], t_end: float) -> float:
    return _worth(received[0], received[0].t_rcv, t_end)


def _worth(message: Message, begin: float, end: float) -> float:
    """Return ∫ of a message's utility from `begin` to `end`, scaled."""
    ages = np.array([begin - message.t_gen]), np.array([end - message.t_gen])
    return message.scale * float(message.utility.integral(*ages)[0])


STANDARD: dict[Aggregation, Callable[[Sequence[Message], float], float]] = {
    Aggregation.MOST_RECENT: _most_recent,
    Aggregation.BEST: _best,
    Aggregation.SUM: _sum,
    Aggregation.ONCE: _once,
}
