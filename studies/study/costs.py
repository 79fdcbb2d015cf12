"""What tasks cost, as measured: the plan says beforehand how long the study takes."""

from collections import Counter
from collections.abc import Sequence

from studies.study.tasks import Task

COSTS = {
    "bound": 0.8,
    "central": 1.0,
    "best": 4.8,
    "paper": 4.8,
    "paper-alone": 2.0,
    "best-alone": 1.0,
    "receding": 1.0,
    "rank": 1.4,
}
"""Processor time of 100 s with ten robots on one core of 2.1 GHz, by contender [s]."""
USUAL_COST = 0.9
SEARCH = 0.6
"""This part of it is spent in searches, in proportion to their iterations."""
START = 1.5
"""What a process takes to start [s]."""


REAL = {"bound": 0.02, "central": 0.02, "reserve": 0.005, "static": 0.005}
REAL_USUAL = 0.06
"""Of real traffic: processor time of one second of one robot [s]."""


def expected(task: Task) -> float:
    """Return about how long a task takes on one core [s]."""
    if task.workload:
        return REAL.get(task.contender, REAL_USUAL) * task.robots * (task.seconds + 5.0)
    cost = COSTS.get(task.contender, USUAL_COST)
    size = task.robots / 10 * max(1.0, task.robots / 10) * (task.seconds + 10.0) / 110.0
    search = SEARCH * task.iterations / 300 + 1.0 - SEARCH
    return cost * size * search


def plan(tasks: Sequence[Task], known: int, jobs: int) -> str:
    """Say what is flown, and how long that takes."""
    counts = Counter(task.contender for task in tasks)
    seconds = sum(map(expected, tasks))
    kinds = ", ".join(f"{count} × {name}" for name, count in counts.most_common())
    lines = [f"{len(tasks)} flights to fly, {known} are known already: {kinds or 'nothing to do'}"]
    wall = (seconds / max(jobs, 1) + START) if tasks else 0.0
    lines.append(f"expected: {time(seconds)} of one core, {time(wall)} with {jobs} at a time")
    return "\n".join(lines)


def time(seconds: float) -> str:
    """Write a time as people say it."""
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"
