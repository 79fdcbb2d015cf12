"""The reductions of §3.2, each alone: nodes of the tree and utility with and without Eq. 4 to 6, and Eq. 7."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, partial
from itertools import product
from pathlib import Path
from statistics import fmean
from typing import Any, Literal

from planner import Problem, SearchSettings
from planner.constraints import violations
from planner.definition import utility
from planner.native_engine import NativeSearch
from planner.python_engine.tree import CUT
from planner.tables import tabulate
from studies.benchmarks.missions import Point, on_all_cores, points
from studies.benchmarks.quality import RuleBrokenError
from studies.benchmarks.report import Figure, Table
from studies.designs.counts import Nodes, Regular, count
from studies.oracle import upper_bound
from studies.policies import Contender
from studies.study.drawing import Style, figure, framed
from studies.study.results import Mean
from studies.workload import SCENARIOS

TEAMS = (Regular(10, 5, 2), Regular(10, 10, 2), Regular(10, 25, 2), Regular(10, 25, 5))
"""Ten streams of 1 Hz under limits of 2 in 0.5 s, 2 in 1 s, 2 and 5 in 2.5 s."""

LEVELS = 30
"""So deep whole trees are counted."""

HORIZONS = (15, 30, 60)
"""Messages in the tree."""

ITERATIONS = 1_500
"""The paper's."""

EVERY = 10
"""Of so many decisions the tree of one is counted."""

Reduction = Literal["off", "paper", "exact"]
REDUCTIONS: tuple[Reduction, ...] = ("off", "paper", "exact")


@dataclass(frozen=True, slots=True)
class Way:
    """How a tree is reduced: by the constraints or not, and by which form of Eq. 7, with a horizon [messages]."""

    constrained: bool
    reduction: Reduction
    horizon: int


WAYS = tuple(Way(*each) for each in product((True, False), REDUCTIONS, HORIZONS))


@dataclass(slots=True)
class Watched:
    """Paper mode that counts its trees. Unless `constrained` its tree may send all messages but the current one.

    That one is checked all the same: what is sent keeps the constraints.
    """

    way: Way
    nodes: list[int] = field(default_factory=list)
    levels: list[int] = field(default_factory=list)
    """The deepest of each tree that was counted."""
    _decided: int = 0

    def __call__(self, window: Problem) -> bool:
        """Search the window and return the decision."""
        settings = SearchSettings(search="paper", reduction=self.way.reduction)
        search = NativeSearch(tabulate(window if self.way.constrained else unconstrained(window)), settings)
        search.run(ITERATIONS)
        if self._decided % EVERY == 0:
            alive = [row[1] for row in search.tree() if row[0] != CUT]
            self.nodes.append(len(alive))
            self.levels.append(int(max(alive)))
        self._decided += 1
        return search.plan().send


def unconstrained(window: Problem) -> Problem:
    """Return a window whose open messages use nothing but for the current one."""
    free = tuple(
        m if m.sent or index == window.current else m._replace(use=(0.0,) * len(m.use))
        for index, m in enumerate(window.messages)
    )
    return replace(window, messages=free)


@dataclass(frozen=True, slots=True)
class Flight:
    """One mission as one way flew it: share of the bound, nodes alive and deepest level of a tree in the mean."""

    point: Point
    way: Way
    share: float
    nodes: float
    levels: float


def measure_reductions(*, quick: bool) -> list[Table | Figure]:
    """Count whole trees and fly the grid in every way; return a figure and tables.

    `quick` flies one mission of 2 s at the tightest limit instead of one of 25 s.
    Raises OracleUnavailable without SciPy.
    """
    seeds, seconds = (1, 2.0) if quick else (1, 25.0)
    places = list(product(points()[: len(SCENARIOS) if quick else None], range(seeds)))
    flown = [one for each in on_all_cores(partial(fly, seconds=seconds), places, alone=quick) for one in each]
    missions = f"{seeds} of {seconds:g} s of each scenario at a limit"
    return [
        Figure("Nodes of each level of the whole tree", draw_counts),
        _counts_table(),
        *(_utility_table(flown, missions, constrained=constrained) for constrained in (True, False)),
        _tree_table(flown),
    ]


def fly(place: tuple[Point, int], *, seconds: float) -> list[Flight]:
    """Fly the mission of a point and a seed in every way.

    Raises RuleBrokenError when one breaks a constraint, OracleUnavailable without SciPy.
    """
    point, seed = place
    flown = point.mission(seed, seconds)
    bound = upper_bound(flown).bound
    found = []
    for way in WAYS:
        watched = Watched(way)
        sends, _ = Contender(str(way), partial(_given, watched)).fly(flown, way.horizon)
        broken = violations(flown, sends)
        if broken:
            raise RuleBrokenError(f"{way}: {broken[0]}")
        found.append(Flight(point, way, utility(flown, sends) / bound, fmean(watched.nodes), fmean(watched.levels)))
    return found


def _given(watched: Watched, _flown: Problem) -> Watched:
    return watched


@cache
def _counted(team: Regular) -> tuple[Nodes, ...]:
    return tuple(count(team, LEVELS))


def _counts_table() -> Table:
    rows = []
    for team in TEAMS:
        known = _counted(team)
        shown = {*range(team.held - 1, team.held + 3), 20, LEVELS}
        rows += [_counts_row(team, nodes, known[nodes.level - 2]) for nodes in known if nodes.level in shown]
    return Table(
        "Nodes of one level of the whole tree",
        (
            "of k messages in a window, level",
            "2^i",
            "Eq. 4–6, the paper's count",
            "Eq. 4–6",
            "times the level before",
            "Eq. 7, by Eq. 8 as printed",
            "Eq. 7",
            "Eq. 4–6 and Eq. 7 (`paper`)",
            "with what windows hold (`exact`)",
        ),
        tuple(rows),
        "Ten Markovian streams that generate in turn, regularly. The paper's count is that of §3.2.1, its r one more"
        " than may be sent: it is exact at the levels k − 1, k and k + 1, and too high beyond. Eq. 8 as printed is too"
        " low: nothing received yet is a state, too, hence n_p + 1. Where a window is no longer than the period of a"
        " stream (k ≤ 10), the last messages say what it holds, and Eq. 7 is exact, as the third footnote says.",
    )


def _counts_row(team: Regular, nodes: Nodes, before: Nodes) -> tuple[str, ...]:
    claimed = "–" if nodes.claimed is None else f"{nodes.claimed:,.0f}"
    counts = (nodes.printed, nodes.states, nodes.both, nodes.exact)
    return (
        f"{team.most} of {team.held}, {nodes.level}",
        f"{nodes.free:,}",
        claimed,
        f"{nodes.allowed:,}",
        f"{nodes.allowed / before.allowed:.2f}",
        *(f"{each:,}" for each in counts),
    )


LINES: tuple[tuple[str, Style, Callable[[Nodes], float | None]], ...] = (
    ("all subsets, 2^i", Style("#000000", "", "--"), lambda nodes: nodes.free),
    ("Eq. 4–6, the paper's count", Style("#D55E00", "x", ":"), lambda nodes: nodes.claimed),
    ("Eq. 4–6", Style("#D55E00", "o", "-"), lambda nodes: nodes.allowed),
    ("Eq. 7", Style("#0072B2", "v", "--"), lambda nodes: nodes.states),
    ("Eq. 4–6 and Eq. 7", Style("#009E73", "s", "-"), lambda nodes: nodes.both),
    ("the same, exact", Style("#000000", "+", ":"), lambda nodes: nodes.exact),
)


def draw_counts(folder: Path) -> str:
    """Draw the nodes of each level of whole trees; return the name of the figure."""
    name = "paper_mode-nodes"
    with figure(folder, name, 1, 3, (11, 4.6), sharey="row") as (drawn, axes):
        for place, team in zip(axes[0], (TEAMS[0], TEAMS[1], TEAMS[3]), strict=True):
            _draw(place, team)
        axes[0][0].set(ylabel="nodes of the level", yscale="log")
        handles, labels = axes[0][0].get_legend_handles_labels()
        drawn.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False)
    return name


def _draw(axes: Any, team: Regular) -> None:
    for label, style, of in LINES:
        shown = [(nodes.level, value) for nodes in _counted(team) if (value := of(nodes)) is not None]
        axes.plot(
            [level for level, _ in shown],
            [value for _, value in shown],
            color=style.colour,
            linestyle=style.dashes,
            marker=style.mark or None,
            markevery=3,
            markerfacecolor="none",
            markersize=5,
            linewidth=1.4,
            label=label,
        )
    axes.set_title(f"{team.most} of {team.held} messages in a window", fontsize=10)
    axes.set_xlabel("level [messages decided]")
    framed(axes)


def _rows(flown: Sequence[Flight]) -> Iterator[tuple[str, list[Flight]]]:
    """Yield what each row of a table says, and the flights it is of."""
    for limit in dict.fromkeys(one.point.limit_name() for one in flown):
        for horizon in HORIZONS:
            yield (
                f"{limit}, horizon {horizon}",
                [one for one in flown if one.point.limit_name() == limit and one.way.horizon == horizon],
            )


def _of(flown: Sequence[Flight], reduction: Reduction, *, constrained: bool) -> list[Flight]:
    return [one for one in flown if one.way.reduction == reduction and one.way.constrained == constrained]


def _more(flown: Sequence[Flight], than: Sequence[Flight]) -> str:
    return Mean.of([one.share - other.share for one, other in zip(flown, than, strict=True)]).percent(2)


def _utility_table(flown: Sequence[Flight], missions: str, *, constrained: bool) -> Table:
    rows = []
    for name, own in [*_rows(flown), ("all", list(flown))]:
        off = _of(own, "off", constrained=constrained)
        reduced = (_more(_of(own, each, constrained=constrained), off) for each in REDUCTIONS[1:])
        less = () if constrained else (_more(off, _of(own, "off", constrained=True)),)
        rows.append((name, f"{100 * fmean(one.share for one in off):.2f}", *less, *reduced))
    return Table(
        f"Utility {'with' if constrained else 'without'} Eq. 4–6 in the tree",
        ("limit", "off", *(() if constrained else ("more than with Eq. 4–6",)), "paper", "exact"),
        tuple(rows),
        f"Share of the offline bound [%] with reduction `off`, and what `paper` and `exact` gain over that [points],"
        f" with the 95 % confidence interval of the mean over missions: {missions}, {ITERATIONS:,} iterations, latency"
        " 10 ms, forecasts from periods and means, one central decider. No constraint was broken"
        + ("." if constrained else ": the current message is checked, later ones of the tree are not."),
    )


def _tree_table(flown: Sequence[Flight]) -> Table:
    rows = []
    for name, own in _rows(flown):
        cells = (_of(own, each, constrained=constrained) for constrained in (False, True) for each in REDUCTIONS)
        rows.append((name, *(f"{fmean(o.nodes for o in c):,.0f} ({fmean(o.levels for o in c):.1f})" for c in cells)))
    heads = (f"{said}, {each}" for said in ("without Eq. 4–6", "with them") for each in REDUCTIONS)
    return Table(
        "Nodes of trees that decided",
        ("limit", *heads),
        tuple(rows),
        f"Nodes alive after {ITERATIONS:,} iterations, each of which makes two at most, in brackets the deepest level;"
        f" the mean over every {EVERY}th decision of the same missions.",
    )
