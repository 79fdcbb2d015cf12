"""What a mission could be worth and what a flight of it was, by the mean of those who want a stream.

Everybody wants everything but what they send themselves: all robots, and an operator who sends nothing. So each stream
has as many receivers as there are robots. What was received in the warm-up counts from its end on.
"""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import replace
from math import ceil, floor, log10

from planner import Message, Problem
from planner.definition import utility
from studies.bench.format import Mission
from studies.oracle import upper_bound
from studies.simulation.records import Delivery
from studies.simulation.scores import scored

DIGITS = 6
"""Of a bound in a file; it is rounded up."""


def bounded(mission: Mission) -> Mission:
    """Return the mission with its bound, and what all samples are worth that nothing limits.

    Raises OracleUnavailable without SciPy.
    """
    problem = scored(mission.problem, mission.head.warm_up)
    everything = utility(replace(problem, constraints=(), messages=_free(problem)), range(len(problem.messages)))
    found = {"bound": _rounded_up(upper_bound(problem).bound), "all": _rounded_up(everything)}
    return replace(mission, head=mission.head.model_copy(update=found))


def reached(mission: Mission, numbers: dict[int, int], deliveries: Iterable[Delivery]) -> float:
    """Return what a flight gained [utility·s]; `numbers` are places of frames in the mission, by identity."""
    received: dict[str, dict[int, float]] = defaultdict(dict)
    for delivery in deliveries:
        if delivery.t_rcv is not None:
            received[delivery.receiver][numbers[id(delivery.frame)]] = delivery.t_rcv
    worth = sum(_received(mission, times) for times in received.values())
    return worth / len(mission.robots)


def _received(mission: Mission, times: dict[int, float]) -> float:
    """Return what one receiver got."""
    problem = mission.problem
    messages = [m._replace(t_rcv=times.get(i, m.t_rcv)) for i, m in enumerate(problem.messages)]
    return utility(scored(replace(problem, messages=tuple(messages)), mission.head.warm_up), times)


def _free(problem: Problem) -> tuple[Message, ...]:
    return tuple(m._replace(use=()) for m in problem.messages)


def _rounded_up(value: float) -> float:
    """Round up to some digits: a bound stays one."""
    unit = 10.0 ** (floor(log10(value)) + 1 - DIGITS)
    return float(f"{ceil(value / unit) * unit:.{DIGITS}g}")
