"""What figures and words of the study are made of: curves, shares, differences and gains."""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from statistics import fmean

from studies.simulation import conditions
from studies.simulation.traffic import missions as traffic
from studies.study.contenders import BOUND, CONTENDERS
from studies.study.programme import COMPARED, Extent, Sweep, agreement_tasks, entered, main_tasks, real_tasks
from studies.study.results import Mean, Results
from studies.study.tasks import Task

SATURATED = 0.995
"""Where less than this part of copies arrives on a channel that loses nothing by itself, the channel is saturated."""


@dataclass(frozen=True, slots=True)
class Spent:
    """Median and 95th percentile of decision times [s], if any was timed, and processor time of one robot [s/s].

    Means over missions; the processor time is that of the whole flight, its network included.
    """

    decision: tuple[float, float] | None
    cpu: float


@dataclass(frozen=True, slots=True)
class Curve:
    """Utility as a part of the maximum by the part of messages that was sent: means at each level."""

    means: tuple[tuple[float, Mean], ...]

    def at(self, sent: float) -> float | None:
        """Return the utility where so much is sent, between the levels flown; None outside of them."""
        points = [(0.0, 0.0), *((x, mean.mean) for x, mean in sorted(self.means, key=lambda each: each[0]))]
        for (x0, y0), (x1, y1) in pairwise(points):
            if x0 <= sent <= x1:
                return y0 + (y1 - y0) * (sent - x0) / (x1 - x0) if x1 > x0 else y1
        return None


def by_level(extent: Extent, contender: str, scenario: str) -> dict[float, list[Task]]:
    """Return the flights of a contender by their level."""
    levels: dict[float, list[Task]] = defaultdict(list)
    for task in main_tasks(extent):
        if task.contender == contender and task.scenario == scenario:
            levels[task.level].append(task)
    return dict(levels)


def curve(results: Results, extent: Extent, contender: str, scenario: str) -> Curve:
    """Return the curve of a contender."""
    means = []
    for tasks in by_level(extent, contender, scenario).values():
        sent, reached = results.mean(tasks, results.sent), results.mean(tasks, results.of_maximum)
        if sent is not None and reached is not None:
            means.append((sent.mean, reached))
    return Curve(tuple(means))


def shares_by_limit(results: Results, extent: Extent, contender: str, scenario: str) -> dict[float, Mean]:
    """Return the mean share of the bound of a contender at each limit; nothing for those that know none."""
    if contender in CONTENDERS and CONTENDERS[contender].random:
        return {}
    means = {
        level: results.mean(tasks, results.share) for level, tasks in by_level(extent, contender, scenario).items()
    }
    return {level: mean for level, mean in means.items() if mean is not None}


def ahead_of(results: Results, extent: Extent, one: str, other: str, scenario: str) -> Iterator[tuple[float, Mean]]:
    """Yield by how much one contender is ahead of another at each limit that both flew, mission by mission [shares]."""
    for level, tasks in by_level(extent, other, scenario).items():
        ahead = results.ahead((entered(one, task), task) for task in tasks)
        if ahead is not None:
            yield level, ahead


def binds(results: Results, extent: Extent, scenario: str, level: float) -> bool:
    """Whether a limit leaves anything to decide: the bound lies below what all messages are worth at that latency."""
    tasks = by_level(extent, BOUND, scenario).get(level, [])
    sent = results.mean(tasks, results.sent)
    return sent is not None and sent.mean < SATURATED


def saturated(results: Results, task: Task) -> bool:
    """Whether the channel lost what it would have carried if less had been sent."""
    record = results.record(task)
    return record is not None and bool(record["network"]) and record["network"]["arrived"] < SATURATED * (1 - task.loss)


def gains_of(results: Results, extent: Extent, scenario: str) -> list[float]:
    """Return what messages gained that were sent at random, over all runs of a scenario."""
    gained: list[float] = []
    for tasks in by_level(extent, "random", scenario).values():
        for task in tasks:
            record = results.record(task)
            gained += [] if record is None else record["gains"]
    return gained


def swept(results: Results, extent: Extent, sweep: Sweep) -> dict[str, dict[float, Mean]]:
    """Return what each line of a sweep reaches at each of its points."""
    lines = _lines(extent, sweep)
    what = results.share if sweep.of == "bound" else results.of_maximum
    found: dict[str, dict[float, Mean]] = {}
    for title, points in lines.items():
        means = {x: results.mean(tasks, what) for x, tasks in points.items()}
        found[title] = {x: mean for x, mean in means.items() if mean is not None}
    return found


def spent(results: Results, extent: Extent, sweep: Sweep) -> dict[str, dict[float, Spent]]:
    """Return what each line of a sweep spends at each of its points."""
    found: dict[str, dict[float, Spent]] = {}
    for title, points in _lines(extent, sweep).items():
        known = {x: what for x, tasks in points.items() if (what := spent_by(results, tasks)) is not None}
        found[title] = known
    return found


def spent_by(results: Results, tasks: Iterable[Task]) -> Spent | None:
    """Return what flights spent by the mean; None: none of them was flown."""
    flown = [(task, record) for task in tasks if (record := results.record(task)) is not None]
    if not flown:
        return None
    decided = [record["decision"] for _, record in flown if record["decision"]]
    middle, late = (fmean(each[k] for each in decided) if decided else 0.0 for k in (0, 1))
    cpu = fmean(record["cpu"] / task.robots / _flown_seconds(task) for task, record in flown)
    return Spent((middle, late) if decided else None, cpu)


def _flown_seconds(task: Task) -> float:
    """Return how long a flight is, with its warm-up [s]."""
    return task.seconds + (traffic.WARM_UP if task.workload else conditions.WARM_UP)


def _lines(extent: Extent, sweep: Sweep) -> dict[str, dict[float, list[Task]]]:
    """Return the flights of a sweep by line and by place on the axis."""
    lines: dict[str, dict[float, list[Task]]] = {}
    for line, x, task in sweep.tasks(extent):
        lines.setdefault(line.title, {}).setdefault(x, []).append(task)
    return lines


def real_flights(results: Results, extent: Extent) -> dict[tuple[str, int], dict[tuple[str, str], list[Task]]]:
    """Return the flights of real traffic that were flown, by workload and robots, then by contender and network."""
    found: dict[tuple[str, int], dict[tuple[str, str], list[Task]]] = {}
    for task in real_tasks(extent):
        if results.share(task) is not None:
            flights = found.setdefault((task.workload, task.robots), {})
            flights.setdefault((task.contender, task.network), []).append(task)
    return found


def agreement(results: Results, extent: Extent) -> dict[tuple[str, float], dict[str, tuple[float, float]]]:
    """Return by scenario and limit what each network lets best mode reach: share of the bound, part that arrived."""
    flown: dict[tuple[str, float], dict[str, list[tuple[float, float]]]] = {}
    for name, task in agreement_tasks(extent):
        share, record = results.share(task), results.record(task)
        if share is not None and record is not None:
            cell = flown.setdefault((task.scenario, task.level), {})
            cell.setdefault(name, []).append((share, record["network"]["arrived"]))
    return {
        place: {name: (fmean(s for s, _ in values), fmean(a for _, a in values)) for name, values in cells.items()}
        for place, cells in flown.items()
        if len(cells) == len(COMPARED)
    }
