"""What the study flies, as data: the study of §4.2, the agreement of the two networks, and sweeps of one thing each."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import product
from typing import Any, Literal

from studies.ns3.network import USUAL
from studies.study.contenders import BOUND, CENTRAL, CONTENDERS, RESERVE, STATIC
from studies.study.tasks import ITERATIONS, REAL_TRAFFIC, Task

SCENARIOS = {"most": "most important", "mixed": "mixed", "few": "few important"}
"""As they are called, in the order of Fig. 3: (a), (b), (c)."""
COMPARED: dict[str, dict[str, Any]] = {
    "adhoc": {},
    "own": {"network": "own"},
    "infrastructure": {"network": "infrastructure", "unicast": True},
    "own, unicast": {"network": "own", "unicast": True},
}
"""Ways to carry the same missions: ns-3's first, then our own medium in its place."""
CARRIED = {"infrastructure": "by unicast over an access point", "adhoc": "by broadcast, ad hoc"}
"""Of these, those that carry real traffic, as the page calls them."""
REAL_TEAMS, REAL_OTHERS = ("best", "paper"), (CENTRAL, RESERVE, STATIC)
"""Who flies real traffic over ns-3, and what that is compared with: over a medium of our own that is as quick."""


@dataclass(frozen=True, slots=True)
class Extent:
    """How much is flown: limits in messages per 2.5 s, probabilities, missions of each kind, seconds.

    `real` are workloads of real traffic, each with its number of robots.
    """

    name: str
    limits: tuple[float, ...]
    probabilities: tuple[float, ...]
    seeds: int
    seconds: float
    sweep_seeds: int
    sweep_seconds: float
    agreement_limits: tuple[float, ...]
    agreement_seeds: int
    real: tuple[tuple[str, int], ...] = (
        ("mixed", 4),
        ("random", 5),
        ("cameras", 4),
        ("cameras-current", 4),
        ("crowd", 12),
    )
    real_seeds: int = 3
    real_seconds: float = 30.0
    contenders: tuple[str, ...] = ()
    sweeps: tuple[str, ...] | None = None
    points: int = 100

    @property
    def flying(self) -> list[str]:
        """Who takes part; all where nobody is named."""
        return [name for name in CONTENDERS if not self.contenders or name in self.contenders]


FULL = Extent(
    "full",
    limits=tuple(float(n) for n in range(1, 31)),
    probabilities=tuple((n + 1) / 30 for n in range(30)),
    seeds=3,
    seconds=100.0,
    sweep_seeds=3,
    sweep_seconds=100.0,
    agreement_limits=(2.0, 5.0, 10.0, 20.0),
    agreement_seeds=3,
)
REDUCED = Extent(
    "reduced",
    limits=(2.0, 5.0, 10.0, 20.0),
    probabilities=(0.08, 0.2, 0.4, 0.8),
    seeds=3,
    seconds=60.0,
    sweep_seeds=2,
    sweep_seconds=20.0,
    agreement_limits=(2.0, 5.0, 10.0),
    agreement_seeds=2,
    real_seeds=2,
    real_seconds=20.0,
)
QUICK = Extent(
    "quick",
    limits=(2.0, 8.0),
    probabilities=(0.1, 0.4),
    seeds=1,
    seconds=15.0,
    sweep_seeds=1,
    sweep_seconds=15.0,
    agreement_limits=(5.0,),
    agreement_seeds=1,
    real=(("random", 5),),
    real_seeds=1,
    real_seconds=5.0,
    contenders=("best", "paper", "random", "greedy"),
    sweeps=("loss",),
    points=2,
)
EXTENTS = {each.name: each for each in (FULL, REDUCED, QUICK)}


@dataclass(frozen=True, slots=True)
class Line:
    """A contender in a sweep, with what is special about it."""

    title: str
    contender: str
    changes: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Sweep:
    """One thing is varied: `points` are what the axis says, and what it changes of the `base`.

    Utility is shown as a share `of` the bound of the same mission, or of the maximum. Between the ends of `flat` it
    should be the same.
    """

    name: str
    title: str
    axis: str
    lines: tuple[Line, ...]
    points: tuple[tuple[float, dict[str, Any]], ...]
    base: dict[str, Any] = field(default_factory=dict)
    logarithmic: bool = False
    of: Literal["bound", "maximum"] = "bound"
    flat: tuple[float, float] | None = None

    def tasks(self, extent: Extent) -> Iterator[tuple[Line, float, Task]]:
        """Yield every flight with its line and its place on the axis."""
        step = max(1, (len(self.points) + extent.points - 1) // extent.points)
        for line, (x, changes), seed in product(self.lines, self.points[::step], range(extent.sweep_seeds)):
            task = entered(line.contender, Task("", "mixed", 5.0, seed, seconds=extent.sweep_seconds))
            yield line, x, task.but(**(self.base | changes | line.changes))


def _varied(name: str, values: Iterable[float]) -> tuple[tuple[float, dict[str, Any]], ...]:
    return tuple((value, {name: value}) for value in values)


BEST = Line("best mode", "best")
PAPER = Line("paper mode", "paper")
ONE = Line("one decides for all", CENTRAL)
LIMITS = _varied("level", (1.0, 2.0, 5.0, 10.0, 15.0, 20.0))
LATENCIES = (0.005, 0.01, 0.03, 0.1, 0.3, 1.0)

SWEEPS = (
    Sweep(
        "robots",
        "Robots, a fifth of whose messages fits",
        "robots",
        (BEST, ONE),
        tuple((n, {"robots": n, "level": 0.5 * n}) for n in (2, 5, 10, 20, 50)),
        logarithmic=True,
    ),
    Sweep(
        "iterations",
        "Iterations of a search",
        "iterations",
        (BEST, PAPER),
        _varied("iterations", (0, 1, 10, 30, 100, 300, 1000, 3000, 10_000)),
        logarithmic=True,
    ),
    Sweep(
        "latency",
        "Latency of messages and of what robots tell each other",
        "latency [ms]",
        (BEST, ONE),
        tuple((1000 * each, {"latency": round(each - USUAL, 6)}) for each in LATENCIES),
        logarithmic=True,
        flat=(10.0, 300.0),
    ),
    Sweep(
        "loss", "Loss of frames", "loss [%]", (BEST,), tuple((100 * p, {"loss": p}) for p in (0, 0.01, 0.1, 0.2, 0.3))
    ),
    Sweep(
        "window",
        "Window T of the constraint, two messages a second",
        "T [s]",
        (BEST, ONE),
        _varied("window", (0.1, 0.25, 0.5, 1.0, 2.5, 5.0)),
        logarithmic=True,
    ),
    Sweep(
        "discovery",
        "Discovery factor c of paper mode (Eq. 3)",
        "c",
        (PAPER,),
        _varied("exploration", (0.0, 0.1, 0.2, 0.35, 0.7, 1.4, 3.0)),
    ),
    Sweep(
        "background",
        "Other traffic on the channel, with fixed and adaptive limits",
        "background [kbit/s]",
        (Line("limit of 10 in 2.5 s", "best"), Line("adaptive limit", "best", {"adaptive": True})),
        tuple((8e-3 * rate, {"background": rate}) for rate in (0.0, 50e3, 100e3, 200e3, 300e3, 400e3)),
        {"level": 10.0},
        of="maximum",
    ),
    Sweep("deciding", "Each alone, or one for all", "limit [messages in 2.5 s]", (BEST, ONE), LIMITS),
    Sweep(
        "generation",
        "Messages that come with a period or at any time (§2.1)",
        "limit [messages in 2.5 s]",
        (Line("periodic", "best"), Line("at any time", "best", {"generation": "aperiodic"})),
        LIMITS,
    ),
    Sweep(
        "aggregation",
        "Streams that are Markovian, or whose messages add up (Eq. 7, 8)",
        "limit [messages in 2.5 s]",
        (
            Line("the newest counts", "best"),
            Line("all add up", "best", {"aggregation": "sum"}),
            Line("each of half of the streams", "best", {"aggregation": "mixed"}),
        ),
        LIMITS,
    ),
)


def entered(contender: str, task: Task) -> Task:
    """Return the task as a contender flies it, with its own number of iterations."""
    iterations = CONTENDERS[contender].iterations if contender in CONTENDERS else ITERATIONS
    return task.but(contender=contender, iterations=iterations)


def main_tasks(extent: Extent) -> list[Task]:
    """Return the flights of §4.2."""
    found = []
    for scenario, seed in product(SCENARIOS, range(extent.seeds)):
        for name in [BOUND, *extent.flying]:
            at_random = name in CONTENDERS and CONTENDERS[name].random
            levels = extent.probabilities if at_random else extent.limits
            found += [entered(name, Task("", scenario, level, seed, seconds=extent.seconds)) for level in levels]
    return found


def agreement_tasks(extent: Extent) -> list[tuple[str, Task]]:
    """Return the flights of best mode over each network, by what that is called in `COMPARED`."""
    flights = product(SCENARIOS, extent.agreement_limits, range(extent.agreement_seeds), COMPARED.items())
    return [
        (name, Task("best", scenario, level, seed, seconds=extent.seconds, **changes))
        for scenario, level, seed, (name, changes) in flights
    ]


def real_tasks(extent: Extent) -> list[Task]:
    """Return the flights of real traffic, without their bounds."""
    found = []
    for (workload, robots), seed in product(extent.real, range(extent.real_seeds)):
        plain = Task("", f"{REAL_TRAFFIC}{workload}", 0.0, seed, robots=robots, seconds=extent.real_seconds)
        names = [*(name for name in REAL_TEAMS if name in extent.flying), *REAL_OTHERS]
        found += [entered(name, plain).but(**COMPARED[network]) for network, name in product(CARRIED, names)]
    return found


def sweeps(extent: Extent) -> list[Sweep]:
    """Return the sweeps that are flown."""
    return [sweep for sweep in SWEEPS if extent.sweeps is None or sweep.name in extent.sweeps]


def sweep_tasks(extent: Extent) -> list[Task]:
    """Return the flights of all sweeps, each with its bound."""
    found = []
    for sweep in sweeps(extent):
        for _, _, task in sweep.tasks(extent):
            found.append(task)
            if sweep.of == "bound":
                found.append(bound_of(task))
    return found


def bound_of(task: Task) -> Task:
    """Return the bound of the mission that a task flies; what changes no mission is left out."""
    plain = Task(BOUND, task.scenario, task.level, task.seed)
    names = ["robots", "seconds", "latency", "window", "generation", "aggregation"]
    if task.workload:  # what samples take depends on the network
        names += ["network", "unicast"]
    return plain.but(**{name: getattr(task, name) for name in names})


def everything(extent: Extent) -> list[Task]:
    """Return all flights of the study, each once, mission by mission: what is interrupted has some of everything."""
    compared = [task for _, task in agreement_tasks(extent)]
    real = real_tasks(extent)
    tasks = [
        *main_tasks(extent),
        *compared,
        *map(bound_of, compared),
        *sweep_tasks(extent),
        *real,
        *map(bound_of, real),
    ]
    return sorted({task.key: task for task in map(normal, tasks)}.values(), key=lambda task: task.seed)


def normal(task: Task) -> Task:
    """Return the task without what does not matter to its contender, so that nothing is flown twice."""
    return bound_of(task) if task.contender == BOUND else task
