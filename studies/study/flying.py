"""Flies one task and measures it; this is what workers run, here or in a cluster."""

from collections.abc import Mapping
from time import process_time

import numpy as np

from planner import Problem, SearchSettings
from planner.definition import utility
from planner.utility import Floats
from studies.central import CentralDecider
from studies.oracle import upper_bound
from studies.policies import Planned
from studies.simulation.conditions import WARM_UP
from studies.simulation.missions import Mission
from studies.simulation.records import OnAir
from studies.simulation.scores import HORIZON, Yardsticks, reached, scored
from studies.study.characteristic import gains, of_runs
from studies.study.contenders import BOUND, CENTRAL, CONTENDERS, Flown
from studies.study.measured import channel, offline, quantiles
from studies.study.missions import mission_of, unlimited
from studies.study.networks import network
from studies.study.real_traffic import fly_real
from studies.study.store import Record
from studies.study.tasks import Task

EXACT = 1e-9
MOST_GAINS = 2_000
"""So many gains of messages are kept of a random run."""


def fly_one(task: Task) -> Record:
    """Fly a task, and return what it reached, as JSON has it.

    `utility` [utility·s], `maximum` is what all messages without delay are worth. `generated`, `sent` and `received`
    are messages (received by the mean of receivers). `over` is the part of windows with more messages than the limit,
    `worst` the most in one, as a part of the limit. `decision` holds median and 95th percentile [s], `cpu` is processor
    time [s]. `network` says how the channel fared. Raises Ns3Unavailable and OracleUnavailable.
    """
    begin = process_time()
    if task.workload:
        record = fly_real(task)
    elif task.contender == BOUND:
        record = _bounded(task)
    elif task.contender == CENTRAL:
        record = _central(task)
    else:
        record = _flown(task)
    return record | {"cpu": round(process_time() - begin, 3)}


def _flown(task: Task) -> Record:
    contender = CONTENDERS[task.contender]
    mission = unlimited(task) if contender.random else mission_of(task)
    with network(task, list(mission.interests)) as carry:
        flight = contender.fly(task, mission, carry)
        record = measured(task, mission, flight)
    if contender.random:
        record["gains"] = _gains(mission, flight, task.seed)
    return record


def measured(task: Task, mission: Mission, flight: Flown) -> Record:
    """Measure a flight."""
    due = sum(frame.t_gen >= WARM_UP for frame in mission.frames)
    messages = [air for air in flight.on_air if air.frame is not None]
    sent = [air for air in messages if air.frame is not None and air.frame.t_gen >= WARM_UP]
    arrived = sum(d.t_rcv is not None and d.frame.t_gen >= WARM_UP for d in flight.deliveries)
    held = _windows(messages, task.window)
    limit = mission.problem.constraints[0].limit
    return {
        "utility": reached(mission, flight),
        "maximum": _maximum(mission.problem),
        "generated": due,
        "sent": len(sent),
        "received": arrived / (1 if task.unicast else len(mission.interests) - 1),
        "over": float(np.mean(held > limit * (1 + EXACT))) if len(held) and limit >= 1.0 else 0.0,
        "worst": float(held.max(initial=0.0) / limit),
        "told": sum(air.size for air in flight.on_air if air.frame is None and air.t >= WARM_UP) / task.seconds,
        "decision": quantiles(flight.decisions),
        "network": _channel(flight, task),
    }


def _maximum(problem: Problem) -> float:
    """What all messages are worth that arrive at once."""
    at_once = tuple(m._replace(t_rcv=m.t_gen) for m in problem.messages)
    ideal = Problem(problem.streams, at_once, 0, (), (), problem.t_start, problem.t_end)
    return utility(scored(ideal), range(len(at_once)))


def _channel(flight: Flown, task: Task) -> Record:
    """Return which part of copies arrived and how late [s], and what all offered [B/s]: so saturation is seen."""
    due = [d for d in flight.deliveries if d.t_sent >= WARM_UP]
    offered = sum(air.size for air in flight.on_air if air.t >= WARM_UP) / task.seconds
    return channel(due, offered + task.background)


def _windows(messages: list[OnAir], window: float) -> Floats:
    """Return how many messages every closed window holds that ends with a send after the warm-up."""
    times = np.sort(np.array([air.t for air in messages], dtype=np.float64))
    held = np.searchsorted(times, times, "right") - np.searchsorted(times, times - window, "left")
    return held[times >= WARM_UP].astype(np.float64)


def _gains(mission: Mission, flight: Flown, seed: int) -> list[float]:
    """Return what messages gained per second of use, whoever received them."""
    number = {id(frame): i for i, frame in enumerate(mission.frames)}
    received: dict[str, dict[int, float]] = {}
    for delivery in flight.deliveries:
        if delivery.t_rcv is not None and delivery.frame.t_gen >= WARM_UP:
            received.setdefault(delivery.receiver, {})[number[id(delivery.frame)]] = delivery.t_rcv
    gained = [gain for times in received.values() for gain in gains(mission.problem, times).tolist()]
    return of_runs(gained, MOST_GAINS, seed)


def _bounded(task: Task) -> Record:
    mission = mission_of(task)
    problem = scored(mission.problem)
    found = upper_bound(problem)
    return _offline(mission, found.bound, dict(enumerate(found.sends.tolist())), problem)


def _central(task: Task) -> Record:
    mission = mission_of(task)
    decider = CentralDecider(mission.problem, HORIZON, forecast=True)
    sends = decider.fly(Planned(SearchSettings(search="best"), task.iterations))
    problem = scored(mission.problem)
    worth = Yardsticks(0.0, sends).central(mission, task.loss, task.seed)
    return _offline(mission, worth, dict.fromkeys(sends, 1.0), problem)


def _offline(mission: Mission, worth: float, sends: Mapping[int, float], problem: Problem) -> Record:
    due = [i for i, m in enumerate(problem.messages) if m.t_gen >= WARM_UP]
    sent = sum(sends.get(i, 0.0) for i in due)
    return offline(worth, _maximum(mission.problem), len(due), sent)
