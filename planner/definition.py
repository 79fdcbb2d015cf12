"""U of a plan by the definition (§2.2), message by message: what the tables of a search must add up to."""

from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise

import numpy as np

from planner.aggregations.custom import Guarded
from planner.problem import Aggregation, AggregationModel, Latest, Message, Problem

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
            if stream.aggregation is Aggregation.CURRENT:
                total -= receiver.share * _lost(_generated(problem, number), before_end, problem.t_end)
    return total


def _generated(problem: Problem, stream: int) -> list[Latest]:
    """Return what is generated of a stream, sent or not, in order."""
    known = problem.streams[stream].newest
    all_known = [Latest(m.t_gen, m.scale) for m in problem.messages if m.stream == stream]
    return sorted(all_known if known is None else [known, *all_known], key=lambda one: one.t_gen)


def _lost(generated: Sequence[Latest], received: Sequence[Message], t_end: float) -> float:
    """Return what messages lose that one receiver is shown while the newest one generated has a smaller scale."""
    lost = 0.0
    times = sorted({t for t, _ in generated} | {m.t_rcv for m in received} | {t_end})
    for begin, end in pairwise(times):
        shown = [m for m in received if m.t_rcv <= begin]
        if shown and end <= t_end:
            newest = [scale for t, scale in generated if t <= begin][-1]
            worth = float(shown[-1].utility.value(np.zeros(1))[0])
            lost += worth * max(0.0, shown[-1].scale - newest) * (end - begin)
    return lost


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
    Aggregation.CURRENT: _most_recent,
}
