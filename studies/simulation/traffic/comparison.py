"""The comparison: contenders that fly the same missions under the same conditions, several at a time."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from time import process_time
from typing import Any

from studies.processes import processes
from studies.simulation.scores import scored
from studies.simulation.traffic.baselines import Simple
from studies.simulation.traffic.flights import How, fly, fly_alone
from studies.simulation.traffic.missions import UNIFORM, WARM_UP, Mission, draw
from studies.simulation.traffic.plan import best_plan, bound
from studies.simulation.traffic.scores import Score, score

LATENCIES = (0.002, 0.02, 0.05, 0.1, 0.2, 0.3, 1.0)
LOSSES = (0.0, 0.01, 0.1)
USUAL = 0.02, 0.01
"""Latency [s] and loss where other things are varied."""
ALL_WAYS = (("random", 5), ("mixed", 4))
"""Workloads and robots that are flown under all combinations of latency and loss."""
ONE_WAY = (
    *(("mixed", robots) for robots in (1, 2, 8)),
    *((name, robots) for name in ("cameras", "cameras-current") for robots in (4, 8)),
    *((f"{UNIFORM}{scenario}", 10) for scenario in ("few", "mixed", "most")),
    *(("crowd", robots) for robots in (12, 50)),
)
"""Those where one of the two is varied at a time."""
LARGE = ("crowd",)
"""Flown with one seed and for at most `LARGE_SECONDS` [s]: a longer mission has more messages than can be bounded."""
LARGE_SECONDS = 20.0
APART = 0.05
"""The bound of a large one looks at windows that end so far apart [s]."""
YARDSTICKS = ("bound", "central", "greedy", "static", "greedy-parts")
"""Besides teams: the linear programme, one decider, and policies that do not plan, with the whole limit or parts."""
PLAN = "plan"
"""The best plan of whole messages."""
SIMPLE = {"greedy": (False, True), "static": (True, False), "greedy-parts": (True, True)}
"""Policies that do not plan: whether each robot has a part of its own, and whether room is kept for small samples."""
PLAN_LIMIT = 60.0
"""So long the plan may be looked for [s]."""


@dataclass(frozen=True, slots=True)
class Cell:
    """One mission and the conditions: latency [s], loss (a probability), seconds after the warm-up."""

    workload: str
    robots: int
    latency: float
    loss: float
    seed: int
    seconds: float

    @property
    def label(self) -> str:
        """What the lines begin with, but for the seed."""
        return f"{self.workload}:{self.robots} {1000 * self.latency:g} ms {100 * self.loss:g} %"

    def mission(self, *, everybody: bool = False) -> Mission:
        """Draw it."""
        seconds = WARM_UP + self.seconds
        return draw(self.workload, self.robots, self.seed, seconds, latency=self.latency, everybody=everybody)


@dataclass(frozen=True, slots=True)
class Task:
    """One flight: `contender` is a yardstick, the plan, or a team: COORDINATION/TRANSPORT[/SETTING=VALUE...]."""

    cell: Cell
    contender: str


@dataclass(frozen=True, slots=True)
class Result:
    """What a flight reached: `utility` of its receivers [utility·s], and its `score`, which bounds and plans have not.

    `sent` are bytes after the warm-up, `samples` all that were generated, `cpu` is processor time [s].
    """

    task: Task
    utility: float
    sent: float
    samples: int
    cpu: float
    score: Score | None = None
    note: str = ""


def grid(seeds: int, seconds: float) -> list[Cell]:
    """Return the cells of the whole comparison."""
    cells = [
        Cell(name, robots, latency, loss, seed, seconds)
        for name, robots in ALL_WAYS
        for latency in LATENCIES
        for loss in LOSSES
        for seed in range(seeds)
    ]
    varied = [*((latency, USUAL[1]) for latency in LATENCIES), *((USUAL[0], loss) for loss in LOSSES)]
    cells += [
        Cell(name, robots, *where, seed, min(seconds, LARGE_SECONDS) if name in LARGE else seconds)
        for name, robots in ONE_WAY
        for where in dict.fromkeys(varied)
        for seed in range(1 if name in LARGE else seeds)
    ]
    return cells


def tasks(cells: Sequence[Cell], contenders: Sequence[str]) -> list[Task]:
    """Return the flights in the order in which they are flown; what loss does not change is looked for once."""
    seen: set[tuple[object, ...]] = set()
    result = []
    for cell in cells:
        for contender in contenders:
            place = (contender, cell.workload, cell.robots, cell.latency, cell.seed)
            if contender in ("bound", PLAN):
                if place in seen:
                    continue
                seen.add(place)
            result.append(Task(cell, contender))
    return result


def fly_all(flights: Sequence[Task], jobs: int) -> Iterator[Result]:
    """Fly all, in so many processes, and yield their results in the same order."""
    if jobs == 1:
        yield from map(fly_one, flights)
        return
    with processes(jobs) as pool:
        yield from pool.map(fly_one, flights)


def fly_one(task: Task) -> Result:
    """Fly one; raise OracleUnavailable where a bound is asked for without SciPy."""
    begin = process_time()
    cell, contender = task.cell, task.contender
    if contender in ("bound", PLAN):
        return _offline(task)
    how = how_of(cell, contender)
    mission = cell.mission(everybody=how.broadcasts)
    if contender == "central":
        mission, flight = fly_alone(mission, how, cell.seed)
        flown = score(mission, flight, cell.loss)
    elif contender in SIMPLE:
        apart, reserve = SIMPLE[contender]
        flown = score(mission, Simple(mission, how, cell.seed, apart, reserve).fly(), cell.loss)
    else:
        flown = score(mission, fly(mission, how, cell.seed), cell.loss)
    cpu = process_time() - begin
    return Result(task, flown.utility, flown.sent, len(mission.frames), cpu, flown)


def how_of(cell: Cell, contender: str) -> How:
    """Return how a contender flies; raise ValueError for one that is written in no known way."""
    if contender in YARDSTICKS:
        return How(latency=cell.latency, loss=cell.loss)
    coordination, *rest = contender.split("/")
    transport, settings = "".join(rest[:1]), rest[1:]
    if transport not in ("unicast", "broadcast"):
        raise ValueError(f"{contender!r}: not COORDINATION/unicast or COORDINATION/broadcast")
    further = tuple((name, _value(text)) for name, text in (each.split("=") for each in settings))
    return How(coordination, transport, cell.latency, cell.loss, settings=further)


def _value(text: str) -> Any:
    try:
        return int(text) if text.isdigit() else float(text)
    except ValueError:
        return text


def _offline(task: Task) -> Result:
    begin = process_time()
    mission = task.cell.mission()
    problem = scored(mission.problem, WARM_UP)
    if task.contender == "bound":
        found = bound(problem, mission.small, APART if task.cell.workload in LARGE else 0.0)
        sent = sum(
            part * frame.size
            for part, frame in zip(found.sends.tolist(), mission.frames, strict=True)
            if frame.t_gen >= WARM_UP
        )
        return Result(task, found.bound, sent, len(mission.frames), process_time() - begin)
    plan = best_plan(problem, certain=mission.small, since=WARM_UP, time_limit=PLAN_LIMIT)
    note = f"limit {PLAN_LIMIT:g} s, took {plan.seconds - plan.bounding:.0f} s, {100 * plan.gap:.2f} % below the bound"
    return Result(task, plan.utility, plan.bytes, len(mission.frames), process_time() - begin, note=note)


def expected(flights: Sequence[Task]) -> float:
    """Return about how long the flights take on one core [s]."""
    return sum(_cost(task) * task.cell.robots * (WARM_UP + task.cell.seconds) for task in flights)


def _cost(task: Task) -> float:
    """Processor time of a second of one robot [s], as measured."""
    factor = {"bound": 0.5, PLAN: 3.0, "central": 1.0}.get(task.contender, 0.1 if task.contender in SIMPLE else 1.3)
    return factor * COSTS.get(task.cell.workload, COST_UNIFORM)


COSTS = {"mixed": 0.11, "random": 0.02, "cameras": 0.02, "cameras-current": 0.02, "crowd": 0.06}
COST_UNIFORM = 0.003
"""Of a second of one robot under a central decider, on a 2 GHz core [s]; twice that in *crowd* where all hear all."""
