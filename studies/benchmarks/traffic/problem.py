"""What was published in a flight, as one problem of the planner."""

from planner import Aggregation, Message, Problem, Stream
from planner.measures import Throughput
from studies.benchmarks.traffic.flight import Flight, Name
from studies.simulation.traffic.workloads import Workload


def published(flight: Flight, workload: Workload) -> tuple[Problem, tuple[Name, ...]]:
    """Return all that was published as a problem in which everything arrives at once, and the name of each message."""
    streams = [(robot, at) for robot, kinds in enumerate(workload.robots) for at in range(len(kinds))]
    number = {name: at for at, name in enumerate(streams)}
    names = tuple(sorted(flight.published, key=lambda name: (flight.published[name].t_gen, name)))
    kinds = [workload.robots[robot][at] for robot, at in streams]
    messages = []
    for name in names:
        of, each = number[name[:2]], flight.published[name]
        t, use = each.t_gen, (float(each.size),)
        messages.append(Message(of, t, t, t, kinds[of].utility, kinds[of].weight, use))
    problem = Problem(
        streams=tuple(
            Stream(robot, Aggregation(kind.aggregation)) for (robot, _), kind in zip(streams, kinds, strict=True)
        ),
        messages=tuple(messages),
        current=0,
        constraints=(Throughput(workload.rate, workload.window).constraint("throughput"),),
        traffic=(),
        t_start=0.0,
        t_end=flight.seconds,
    )
    return problem, names
