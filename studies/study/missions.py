"""The missions of the study: those of §4.2, and what is changed in some of them."""

from dataclasses import replace

import numpy as np

from planner import Aggregation, Constraint, Message, Problem, Stream
from studies.simulation.conditions import WARM_UP, WINDOW, Conditions
from studies.simulation.missions import Mission, of_equal, scenario
from studies.study.networks import usual_delay
from studies.study.tasks import Task
from studies.workload import mission

CEILING = 600_000.0
"""More than the channel bears [B/s]: where a team that looks for its limit begins to look."""
APERIODIC = 1_000
"""Added to the seed of what is drawn anew."""


def mission_of(task: Task) -> Mission:
    """Draw the mission of a task: the same one for all contenders and networks."""
    limit = Constraint("messages", task.window, task.level * task.window / WINDOW)
    problem = mission(
        scenario(task.scenario),
        task.seed,
        seconds=WARM_UP + task.seconds,
        robots=task.robots,
        latency=usual_delay(task),
        constraint=limit,
    )
    if task.generation == "aperiodic":
        problem = _at_random(problem, task)
    if task.aggregation != "most_recent":
        every = 1 if task.aggregation == "sum" else 2
        problem = replace(problem, streams=tuple(_summed(stream, every) for stream in problem.streams))
    how = Conditions(
        transport="unicast" if task.unicast else "broadcast",
        latency=usual_delay(task),
        seconds=task.seconds,
        robots=task.robots,
        window=task.window,
        iterations=task.iterations,
    )
    throughput = f'limit = "adaptive"\nceiling = "{CEILING!r} B/s"' if task.adaptive else ""
    return of_equal(problem, how, throughput)


def unlimited(task: Task) -> Mission:
    """Return the mission of a contender that knows no limit, whose `level` is a probability."""
    return mission_of(task.but(level=2.0 * WINDOW * task.robots))


def _at_random(problem: Problem, task: Task) -> Problem:
    """Let as many messages come at any time (§2.1): those of a stream in their order, as a Poisson process has it."""
    draw = np.random.default_rng(APERIODIC + task.seed)
    messages: list[Message] = []
    for number in range(len(problem.streams)):
        own = [m for m in problem.messages if m.stream == number]
        times = np.sort(draw.uniform(problem.t_start, problem.t_end, len(own))).tolist()
        messages += [
            m._replace(t_gen=t, t_sent=t, t_rcv=t + m.t_rcv - m.t_gen) for m, t in zip(own, times, strict=True)
        ]
    messages.sort(key=lambda m: (m.t_gen, m.stream))
    return replace(problem, messages=tuple(messages))


def _summed(stream: Stream, every: int) -> Stream:
    """Let the messages of a stream add up, of every robot or of each second one."""
    return stream._replace(aggregation=Aggregation.SUM) if stream.robot % every == 0 else stream
