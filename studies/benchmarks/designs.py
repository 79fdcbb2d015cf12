"""Designs: what each design of the search loses, of the optima of missions and of those of windows."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from statistics import fmean

import numpy as np

import planner
from planner import Constraint, Problem, SearchSettings
from planner.constraints import violations
from planner.definition import utility
from planner.tables import tabulate
from studies.benchmarks.quality import PATIENCE, RuleBrokenError
from studies.benchmarks.report import Table
from studies.central import CentralDecider
from studies.designs.catalogue import AS_IT_IS, BUDGET, catalogue
from studies.designs.design import Decider, Design, worth
from studies.oracle import optimum
from studies.processes import processes
from studies.workload import SCENARIOS, TWO_PER_HALF_SECOND, mission

LIMITS = (TWO_PER_HALF_SECOND, Constraint("messages", 2.5, 5.0), Constraint("units", 0.5, 2.0))
"""So many messages per window of so many seconds; the last one counts units of their sizes."""

SIZES = (0.3, 1.7)
"""The least and the greatest size of a message."""

SHORT, LONG = 30, 60
"""Horizons [messages]."""

FLOWN_LONG = (
    "widening beam, 60 rounds, 3,000 nodes",
    AS_IT_IS,
    "best mode without the tree",
    "best mode without the sweep",
    "best mode without what lies beyond",
    "best mode, deflected directions",
)
"""The designs that fly with the long horizon, too; the others take too long or have lost before."""

WORKERS = 2
PROOF = 20_000
"""Iterations within which the best plan of a window is to be proven."""

CLOSE = 1e-6
"""How far below the optimum, as a part of it, a plan still is the best one."""


@dataclass(frozen=True, slots=True)
class Mission:
    """A mission: a limit and a scenario by their places, a seed, and how long it is [s]."""

    limit: int
    scenario: int
    seed: int
    seconds: float

    def draw(self) -> Problem:
        """Draw its messages."""
        limit = LIMITS[self.limit]
        drawn = mission(SCENARIOS[self.scenario], self.seed, seconds=self.seconds, constraint=limit)
        if limit.name != "units":
            return drawn
        sizes = np.random.default_rng(self.seed).uniform(*SIZES, len(drawn.messages)).tolist()
        messages = (message._replace(use=(size,)) for message, size in zip(drawn.messages, sizes, strict=True))
        return replace(drawn, messages=tuple(messages))


@dataclass(frozen=True, slots=True)
class Extent:
    """How much is measured: missions of so many seconds, and so many windows after the first messages of each.

    `limits` are those of missions flown with the short horizon, and of all others.
    """

    limits: tuple[int, int]
    seconds: float
    begin: int
    windows: int

    def missions(self, limits: int) -> list[Mission]:
        """Return a mission for each of so many limits and each scenario."""
        return [Mission(limit, scenario, 0, self.seconds) for limit, scenario in product(range(limits), range(3))]


FULL = Extent(limits=(2, 3), seconds=30.0, begin=100, windows=15)
QUICK = Extent(limits=(1, 1), seconds=1.5, begin=5, windows=2)


@dataclass(frozen=True, slots=True)
class Measured:
    """What one design made of a mission or its windows.

    `lost` is the part of the optimum that it missed, None where it maximises something else. `right` is the part of the
    windows whose best plan it found, `sure` how many optima are proven.
    """

    design: str
    lost: float | None
    iterations: float
    plans: float
    right: float = 0.0
    sure: int = 0


Job = Callable[[Mission], list[Measured]]


def measure_designs(*, quick: bool) -> list[Table]:
    """Fly missions and search windows with all designs; return a table of each.

    `quick` takes seconds instead of minutes. Raises OracleUnavailable without SciPy.
    """
    extent = QUICK if quick else FULL
    few, all_ = (extent.missions(limits) for limits in extent.limits)
    names = tuple(design.name for design in catalogue())
    short = _run(partial(fly, names=names, horizon=SHORT), few, quick=quick)
    long = _run(partial(fly, names=FLOWN_LONG, horizon=LONG), all_, quick=quick)
    windows = _run(partial(search, horizon=LONG, begin=extent.begin, count=extent.windows), all_, quick=quick)
    return [_flown(few, short, SHORT), _flown(all_, long, LONG), _searched(all_, windows, extent.windows)]


def _run(measure: Job, points: Sequence[Mission], *, quick: bool) -> list[list[Measured]]:
    if quick:
        return [measure(point) for point in points]
    with processes(WORKERS) as pool:
        return list(pool.map(measure, points))


def fly(point: Mission, *, names: Sequence[str], horizon: int) -> list[Measured]:
    """Fly one mission with the designs of these names; raise RuleBrokenError when one breaks a constraint."""
    flown = point.draw()
    best = optimum(flown, PATIENCE)
    return [_flight(design, flown, horizon, best.utility, best.exact) for design in catalogue() if design.name in names]


def _flight(design: Design, flown: Problem, horizon: int, best: float, proven: bool) -> Measured:  # noqa: FBT001
    decider = design.decider()
    sends = CentralDecider(flown, horizon).fly(decider.decide)
    broken = violations(flown, sends)
    if broken:
        raise RuleBrokenError(f"{design.name}: {broken[0]}")
    return _measured(design, decider, 1 - utility(flown, sends) / best, sure=int(proven))


def search(point: Mission, *, horizon: int, begin: int, count: int) -> list[Measured]:
    """Search consecutive windows of one mission with all designs."""
    windows = [_Window.of(window) for window in consecutive(point.draw(), horizon, begin, count)]
    return [_search(design, windows) for design in catalogue()]


def consecutive(flown: Problem, horizon: int, begin: int, count: int) -> Iterator[Problem]:
    """Fly a mission by best mode; yield the windows of so many messages from the message `begin`."""
    decider = CentralDecider(flown, horizon)
    for index in range(begin + count):
        window = decider.window(index)
        if index >= begin:
            yield window
        found = planner.start(window, SearchSettings())
        found.run(BUDGET)
        if found.plan().send:
            decider.send(index)


@dataclass(frozen=True, slots=True)
class _Window:
    """A window and what its best plan is worth more than its facts alone [utility·s]."""

    problem: Problem
    best: float
    proven: bool

    @classmethod
    def of(cls, window: Problem) -> "_Window":
        """Find the optimum of the objective."""
        settings = SearchSettings()
        found = planner.start(window, settings)
        found.run(PROOF)
        plan, tables = found.plan(), tabulate(window, beyond=True)
        sends = [level for level, message in enumerate(tables.message) if message in plan.sends]
        return cls(window, worth(tables, sends), found.done and plan.nodes < settings.max_nodes)


def _search(design: Design, windows: Sequence[_Window]) -> Measured:
    decider, reached, other = design.decider(), [], False
    for window in windows:
        found = decider.search(window.problem)
        other = other or found.tables.beyond is None
        reached.append(worth(found.tables, found.sends()))
    pairs = list(zip(reached, windows, strict=True))
    right = fmean(own >= window.best - CLOSE * abs(window.best) for own, window in pairs)
    lost = 1 - sum(reached) / sum(window.best for window in windows)
    return _measured(design, decider, None if other else lost, right, sum(window.proven for window in windows))


def _measured(design: Design, decider: Decider, lost: float | None, right: float = 0.0, sure: int = 0) -> Measured:
    return Measured(
        design.name, lost, decider.iterations / decider.decisions, decider.plans / decider.iterations, right, sure
    )


def _by_design(measured: Sequence[Sequence[Measured]]) -> list[list[Measured]]:
    return [list(of_all_points) for of_all_points in zip(*measured, strict=True)]


def _heads(points: Sequence[Mission]) -> tuple[str, ...]:
    limits = [LIMITS[point.limit] for point in points]
    return tuple(
        f"{SCENARIOS[point.scenario].name}, {limit.limit:g} {limit.name} per {limit.window:g} s"
        for point, limit in zip(points, limits, strict=True)
    )


WORK = ("iterations", "plans per iteration")


def _work(own: Sequence[Measured]) -> tuple[str, ...]:
    return f"{fmean(one.iterations for one in own):,.0f}", f"{fmean(one.plans for one in own):.2f}"


def _flown(points: Sequence[Mission], measured: Sequence[Sequence[Measured]], horizon: int) -> Table:
    rows = []
    for own in _by_design(measured):
        losses = [100 * (one.lost or 0.0) for one in own]
        rows.append((own[0].design, *(f"{loss:.2f}" for loss in (*losses, fmean(losses))), *_work(own)))
    sure = sum(of_point[0].sure for of_point in measured)
    return Table(
        f"Missions, horizon {horizon}: utility lost against the integer optimum [%]",
        ("design", *_heads(points), "mean", *WORK),
        tuple(rows),
        f"One mission of {points[0].seconds:g} s a point, exact forecasts, one central decider; at most {BUDGET}"
        " iterations a decision, except of beams. An iteration is a round of learning, one leaf tried, or of a beam one"
        " node extended by a level, which is far less; a plan counts when it was completed to the end of the window."
        f" Units are sizes of messages, evenly drawn from {SIZES[0]:g} to {SIZES[1]:g}. The integer optimum is proven"
        f" for {sure} of {len(points)}. No constraint was broken.",
    )


def _searched(points: Sequence[Mission], measured: Sequence[Sequence[Measured]], count: int) -> Table:
    rows = []
    for own in _by_design(measured):
        losses = [100 * one.lost for one in own if one.lost is not None]
        if losses:
            found = f"{100 * fmean(one.right for one in own):.1f}"
            rows.append((own[0].design, *(f"{loss:.3f}" for loss in (*losses, fmean(losses))), found, *_work(own)))
    sure = sum(of_point[0].sure for of_point in measured)
    return Table(
        f"Windows, horizon {LONG}: objective lost against the best plan of the window [%]",
        ("design", *_heads(points), "mean", "best plan found [%]", *WORK),
        tuple(rows),
        f"{count} consecutive windows a point, the same for all designs, out of the midst of missions flown by best"
        " mode: what the objective lacks in all together, of what it may gain over sending nothing. The best plans are"
        f" best mode's within {PROOF:,} iterations, proven for {sure} of {count * len(points)}. Designs that maximise"
        " something else are left out.",
    )
