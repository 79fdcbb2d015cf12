"""What a flight was worth, and what it used."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from random import Random
from statistics import fmean

import numpy as np

from planner import Problem, SearchSettings
from planner.definition import utility
from studies.central import CentralDecider
from studies.oracle import upper_bound
from studies.policies import Planned
from studies.simulation.flights import WARM_UP, WINDOW, Conditions, Mission
from studies.simulation.records import Delivery, OnAir
from studies.simulation.team import Team

HORIZON = 60
DRAWS = 20
"""So many draws of what is lost, for the central decider."""


@dataclass(frozen=True, slots=True)
class Yardsticks:
    """The offline bound of a mission [utility·s], and what one central decider reaches."""

    bound: float
    central: float


@dataclass(frozen=True, slots=True)
class Use:
    """What was sent: messages per second, and by how many messages a window exceeds the limit.

    `exceeding` is the part of all windows that end with a send and hold more than the limit, `worst` the most messages
    above it; `exceeding_all` is the part of windows in which messages and digests together exceed theirs. `digests` is in
    B/s per robot, copies counted.
    """

    messages: float
    exceeding: float
    worst: int
    exceeding_all: float
    digests: float


def measure(flown: Mission, how: Conditions, seed: int) -> Yardsticks:
    """Bound the mission and let one decider fly it, at the same latency and loss."""
    bound = upper_bound(scored(flown.problem)).bound
    sends = CentralDecider(flown.problem, HORIZON, forecast=True).fly(
        Planned(SearchSettings(search="best"), how.iterations)
    )
    return Yardsticks(bound, _with_loss(scored(flown.problem), sends, how.loss, seed))


def scored(problem: Problem) -> Problem:
    """Return the mission as far as it is scored: what was received before the end of the warm-up counts from then on."""
    return replace(problem, messages=tuple(replace(m, t_rcv=max(m.t_rcv, WARM_UP)) for m in problem.messages))


def reached(flown: Mission, team: Team) -> float:
    """What the receivers got, by the mean of those who want a stream [utility·s]."""
    number = {id(frame): i for i, frame in enumerate(flown.frames)}
    received: dict[str, dict[int, float]] = {}
    for delivery in team.deliveries:
        if delivery.t_rcv is not None:
            received.setdefault(delivery.receiver, {})[number[id(delivery.frame)]] = delivery.t_rcv
    return sum(_worth(flown, times, receiver) for receiver, times in received.items())


def use(team: Team, how: Conditions) -> Use:
    """Count what a flight sent after its warm-up."""
    air = [sent for sent in team.on_air if sent.t >= WARM_UP - WINDOW]
    messages = [sent for sent in air if sent.frame is not None]
    digests = sum(sent.size for sent in air if sent.frame is None and sent.t >= WARM_UP)
    counts = windows(messages, [1.0] * len(messages))
    ends = np.array([sent.t >= WARM_UP for sent in messages], dtype=bool)
    counted = counts[ends]
    together = windows(air, [float(sent.size) for sent in air])[[sent.t >= WARM_UP for sent in air]]
    return Use(
        messages=len(counted) / how.seconds,
        exceeding=float(np.mean(counted > how.limit)) if len(counted) else 0.0,
        worst=max(0, int(counted.max(initial=0)) - how.limit),
        exceeding_all=float(np.mean(together > how.gross * (1 + 1e-9))) if len(together) else 0.0,
        digests=digests / how.seconds / how.members,
    )


def windows(sent: Sequence[OnAir], uses: Sequence[float]) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Return what the closed window that ends with each of these uses."""
    times = np.array([each.t for each in sent])
    sums = np.concatenate(([0.0], np.cumsum(uses)))
    first = np.searchsorted(times, times - WINDOW, "left")
    last = np.searchsorted(times, times, "right")
    return np.asarray(sums[last] - sums[first])


def same_decisions(one: Iterable[Delivery], other: Iterable[Delivery], frames: Sequence[object]) -> float:
    """Return the part of all frames after the warm-up that both flights sent, or neither."""
    sent = [{id(delivery.frame) for delivery in each} for each in (one, other)]
    due = [frame for frame in frames if frame.t_gen >= WARM_UP]  # type: ignore[attr-defined]
    return fmean((id(frame) in sent[0]) == (id(frame) in sent[1]) for frame in due)


def _worth(flown: Mission, times: dict[int, float], receiver: str) -> float:
    """What one receiver got, its part of all who want the same."""
    receivers = [robot for robot, keys in flown.interests.items() if keys]
    messages = tuple(
        replace(m, t_rcv=max(times.get(i, m.t_rcv), WARM_UP)) for i, m in enumerate(flown.problem.messages)
    )
    total = utility(replace(flown.problem, messages=messages), times)
    others = sum(1 for robot in receivers) - (receiver != "op")
    return total / others


def _with_loss(problem: Problem, sends: Sequence[int], loss: float, seed: int) -> float:
    """What these sends are worth to a receiver on average, if so many are lost."""
    if loss == 0.0:
        return utility(problem, sends)
    draw = Random(seed)
    return fmean(utility(problem, [i for i in sends if draw.random() >= loss]) for _ in range(DRAWS))
