"""What robots really send (`studies/simulation/traffic`), flown over the networks of the study."""

from dataclasses import replace
from typing import Any

from planner import Message
from studies.simulation.missions import OPERATOR
from studies.simulation.scores import scored
from studies.simulation.traffic.baselines import Simple
from studies.simulation.traffic.comparison import APART, LARGE, SIMPLE
from studies.simulation.traffic.flights import How, fly_alone
from studies.simulation.traffic.missions import WARM_UP, Mission, draw
from studies.simulation.traffic.plan import bound
from studies.simulation.traffic.scores import Flight, score, worth
from studies.study.contenders import BOUND, CENTRAL, CONTENDERS, RESERVE, STATIC
from studies.study.measured import channel, offline, quantiles
from studies.study.networks import network, own_rate
from studies.study.store import Record
from studies.study.tasks import Task

SENDERS = {RESERVE: SIMPLE["greedy"], STATIC: SIMPLE["static"]}
QUICK = 0.0005
"""What the smallest sample takes on ns-3's channels [s]; the others take the longer the larger they are."""


def fly_real(task: Task) -> Record:
    """Fly a task of real traffic, and return what it reached as `fly_one` does, for the operator.

    `small` is the part of small samples that came, `age` their age then (median, 95th percentile) [s], `alarms` the
    part of alarms that was sent.
    """
    mission = mission_of(task)
    if task.contender == BOUND:
        return _bounded(task, mission)
    how = How(
        transport="unicast" if task.unicast else "broadcast",
        latency=task.latency + QUICK,
        loss=0.0,
        iterations=task.iterations,
        rate=own_rate(task),
    )
    if task.contender == CENTRAL:
        return _record(*fly_alone(mission, how, task.seed), decided=())
    if task.contender in SENDERS:
        apart, reserve = SENDERS[task.contender]
        return _record(mission, Simple(mission, how, task.seed, apart, reserve).fly(), decided=())
    fly: Any = CONTENDERS[task.contender].fly  # a team's, which takes missions of either kind
    with network(task, list(mission.interests)) as carry:
        flight = fly(task, mission, carry)
    return _record(mission, flight, decided=flight.decisions)


def mission_of(task: Task) -> Mission:
    """Draw the mission: the same traffic for all contenders; samples take as long as they usually do on the network."""
    seconds, rate = WARM_UP + task.seconds, own_rate(task)
    drawn = draw(task.workload, task.robots, task.seed, seconds, latency=0.0, everybody=not task.unicast)
    messages: list[Message] = []
    last: dict[int, float] = {}
    for m in drawn.problem.messages:  # those of a stream come in order
        last[m.stream] = max(m.t_gen + task.latency + QUICK + m.use[0] / rate, last.get(m.stream, 0.0))
        messages.append(m._replace(t_rcv=last[m.stream]))
    return replace(drawn, problem=replace(drawn.problem, messages=tuple(messages)))


def _record(mission: Mission, flight: Flight, *, decided: Any) -> Record:
    found = score(mission, flight, 0.0)
    number = {id(frame): i for i, frame in enumerate(mission.frames)}
    came = {number[id(d.frame)]: d.t_rcv for d in flight.deliveries if d.receiver == OPERATOR and d.t_rcv is not None}
    due = [d for d in flight.deliveries if d.t_sent >= WARM_UP]
    end = mission.problem.t_end
    offered = (found.sent + found.told * (end - WARM_UP)) / end
    return {
        "utility": worth(mission, came),
        "maximum": _maximum(mission),
        "generated": sum(frame.t_gen >= WARM_UP for frame in mission.frames),
        "sent": sum(air.frame is not None and air.frame.t_gen >= WARM_UP for air in flight.on_air),
        "received": sum(mission.frames[i].t_gen >= WARM_UP for i in came),
        "over": found.over,
        "worst": found.worst,
        "told": found.told,
        "decision": quantiles(list(decided)),
        "network": channel(due, offered),
        "small": found.arrived,
        "age": list(found.age),
        "alarms": found.alarms_sent / found.alarms if found.alarms else 1.0,
    }


def _bounded(task: Task, mission: Mission) -> Record:
    found = bound(scored(mission.problem, WARM_UP), mission.small, APART if task.workload in LARGE else 0.0)
    due = [i for i, frame in enumerate(mission.frames) if frame.t_gen >= WARM_UP]
    sent = float(sum(found.sends[i] for i in due))
    record = offline(found.bound, _maximum(mission), len(due), sent)
    return record | {"small": 1.0, "age": [], "alarms": 1.0}


def _maximum(mission: Mission) -> float:
    """What all messages are worth that arrive at once."""
    return worth(mission, {i: frame.t_gen for i, frame in enumerate(mission.frames)})
