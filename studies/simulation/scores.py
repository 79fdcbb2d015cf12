"""What a flight was worth, beside what it could have been."""

from dataclasses import dataclass, replace
from random import Random
from statistics import fmean

from planner import Problem, SearchSettings
from planner.definition import utility
from studies.central import CentralDecider
from studies.oracle import upper_bound
from studies.policies import Planned
from studies.simulation.conditions import WARM_UP
from studies.simulation.missions import OPERATOR, Mission
from studies.simulation.records import Flown

HORIZON = 60
"""Of the central decider [messages]."""
DRAWS = 20
"""So many draws of what it loses on the air."""


@dataclass(frozen=True, slots=True)
class Yardsticks:
    """The offline bound of a mission [utility·s], and what one central decider sends, by index."""

    bound: float
    sends: tuple[int, ...]

    def central(self, flown: Mission, loss: float, seed: int) -> float:
        """Return what the central decider reaches with a receiver on average, if so many are lost [utility·s]."""
        problem = scored(flown.problem)
        if loss == 0.0:
            return utility(problem, self.sends)
        draw = Random(seed)
        return fmean(utility(problem, [i for i in self.sends if draw.random() >= loss]) for _ in range(DRAWS))


def measure(flown: Mission, iterations: int) -> Yardsticks:
    """Bound the mission, and let one decider fly it that expects periods and means, at the same latency.

    Raises OracleUnavailable without SciPy.
    """
    decider = CentralDecider(flown.problem, HORIZON, forecast=True)
    sends = decider.fly(Planned(SearchSettings(search="best"), iterations))
    return Yardsticks(upper_bound(scored(flown.problem)).bound, sends)


def scored(problem: Problem, since: float = WARM_UP) -> Problem:
    """Return the mission as it is scored: what was received before the end of the warm-up counts from then on."""
    return replace(problem, messages=tuple(m._replace(t_rcv=max(m.t_rcv, since)) for m in problem.messages))


def reached(flown: Mission, flight: Flown) -> float:
    """What the receivers got, by the mean of those who want a stream [utility·s]."""
    number = {id(frame): i for i, frame in enumerate(flown.frames)}
    received: dict[str, dict[int, float]] = {}
    for delivery in flight.deliveries:
        if delivery.t_rcv is not None:
            received.setdefault(delivery.receiver, {})[number[id(delivery.frame)]] = delivery.t_rcv
    return sum(_worth(flown, times, receiver) for receiver, times in received.items())


def sent(flown: Mission, flight: Flown) -> frozenset[int]:
    """Return the frames that were sent, by index."""
    number = {id(frame): i for i, frame in enumerate(flown.frames)}
    return frozenset(number[id(air.frame)] for air in flight.on_air if air.frame is not None)


def same_decisions(flown: Mission, one: frozenset[int], other: frozenset[int]) -> float:
    """Return the part of all frames after the warm-up that both flights sent, or neither."""
    due = [i for i, frame in enumerate(flown.frames) if frame.t_gen >= WARM_UP]
    return fmean((i in one) == (i in other) for i in due)


def _worth(flown: Mission, times: dict[int, float], receiver: str) -> float:
    """What one receiver got, divided by how many want the same."""
    messages = tuple(
        m._replace(t_rcv=max(times.get(i, m.t_rcv), WARM_UP)) for i, m in enumerate(flown.problem.messages)
    )
    wanting = sum(map(bool, flown.interests.values())) - (receiver != OPERATOR)
    return utility(replace(flown.problem, messages=messages), times) / wanting
