"""Deviations: what each thing is worth that paper mode does otherwise than §3 of the paper, on the planner's grid."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from statistics import fmean

from planner import Problem, SearchSettings
from planner.constraints import violations
from planner.definition import utility
from studies.benchmarks.missions import HORIZON, Point, on_all_cores, points
from studies.benchmarks.quality import RuleBrokenError
from studies.benchmarks.report import Table
from studies.central import Policy
from studies.designs.literal import DescendantsAlone, Literal, NewChild
from studies.designs.paper import Paper
from studies.oracle import upper_bound
from studies.policies import Contender, Planned
from studies.study.results import Mean
from studies.workload import SCENARIOS

BUDGETS = (300, 1_500)
"""Iterations of a decision: those of the grid, and the paper's."""

MANY = 30_000
"""More iterations than the arena has room for."""

UNBOUNDED = 2**24
"""Nodes of an arena that none of these searches fills."""

PAPER = SearchSettings(search="paper")
Fresh = Callable[[Problem, int], Policy]
"""Makes a policy for one mission and so many iterations."""


@dataclass(frozen=True, slots=True)
class Form:
    """Paper mode as it is, or with something to the letter.

    Without a horizon all messages of the mission are in the tree. What is `slow`, because only the Python engine does
    it, flies one mission of a point, and with the least budget.
    """

    name: str
    fresh: Fresh
    horizon: int | None = HORIZON
    slow: bool = False

    def fly(self, flown: Problem, iterations: int) -> tuple[int, ...]:
        """Return what is sent of a mission; raise RuleBrokenError when that breaks a constraint."""
        contender = Contender(self.name, partial(_of_iterations, self.fresh, iterations))
        sends, _ = contender.fly(flown, self.horizon or len(flown.messages))
        broken = violations(flown, sends)
        if broken:
            raise RuleBrokenError(f"{self.name}: {broken[0]}")
        return sends


def _of_iterations(fresh: Fresh, iterations: int, flown: Problem) -> Policy:
    return fresh(flown, iterations)


def _as_it_is(settings: SearchSettings = PAPER) -> Fresh:
    return lambda _, iterations: Planned(settings, iterations)


def _reduced(settings: SearchSettings) -> Form:
    return Form(f"reduction off → {settings.reduction}", _as_it_is(settings))


def forms() -> tuple[Form, ...]:
    """Return paper mode as it is, and then with each deviation taken back: what it does → what the paper says."""
    exact, eq7 = SearchSettings(search="paper", reduction="exact"), SearchSettings(search="paper", reduction="paper")
    letter = partial(_literal, whole=True, considered=True, floor=False)
    return (
        Form("paper mode as it is", _as_it_is()),
        Form("U to the window's end → to the mission's", _literal(to_the_end=True)),
        Form("U(M) of the window → of the mission, M_v since its start", _literal(whole=True)),
        Form("ψ of the next undecided message → of the one considered", _literal(considered=True)),
        Form("ψ of 0.01 s at least → no floor", _literal(floor=False)),
        Form("the node reached is scored → a new child", _literal(search=NewChild), slow=True),
        Form(
            "mean score with the node's own → of descendants alone",
            _literal(search=DescendantsAlone),
            slow=True,
        ),
        Form(f"a tree of {HORIZON} messages → of all to the mission's end", _as_it_is(), None),
        _reduced(eq7),
        _reduced(exact),
        Form("U, ψ and the tree all to the letter, reduction off", letter(), None),
        Form(
            "U, ψ and the tree all to the letter, reduction paper",
            letter(settings=eq7),
            None,
        ),
    )


def _literal(
    *,
    to_the_end: bool = False,
    whole: bool = False,
    considered: bool = False,
    floor: bool = True,
    stretched: bool = True,
    search: type[Paper] | None = None,
    settings: SearchSettings = PAPER,
) -> Fresh:
    return lambda flown, iterations: Literal(
        flown, settings, iterations, to_the_end, whole, considered, floor, stretched, search
    )


@dataclass(frozen=True, slots=True)
class Flight:
    """One mission as one form of paper mode flew it: the share of the bound."""

    point: Point
    seed: int
    form: str
    share: float


@dataclass(frozen=True, slots=True)
class Extent:
    """How much is flown: missions of so many seconds at every point; `quick` ones only at the tightest limit."""

    seeds: int
    seconds: float
    points: int | None = None

    def places(self, where: Sequence[Point]) -> list[tuple[Point, int]]:
        """Return the missions by point and seed."""
        return list(product(where[: self.points], range(self.seeds)))

    def missions(self) -> str:
        """Say how many missions of a point there are, and of what length."""
        return f"{self.seeds} mission{'s' if self.seeds > 1 else ''} of {self.seconds:g} s"

    def said(self, *, quick: bool = False) -> str:
        """Say it in a note."""
        where = "the tightest limit" if quick else "each limit of the grid"
        return f"{self.missions()} of each scenario at {where}"


FULL, FEW = Extent(2, 25.0), Extent(1, 15.0)
QUICK = Extent(1, 2.0, len(SCENARIOS))


def measure_deviations(*, quick: bool) -> list[Table]:
    """Fly the grid with every form of paper mode; return a table for each budget, one of the arena, one of sizes.

    `quick` takes seconds instead of a quarter of an hour. Raises OracleUnavailable without SciPy.
    """
    extent, few = (QUICK, QUICK) if quick else (FULL, FEW)
    found = []
    for budget in BUDGETS:
        job = partial(fly, catalogue=forms, iterations=budget, seconds=extent.seconds)
        found.append(_worth_table(_flown(job, points(), extent, alone=quick), budget, extent.said(quick=quick)))
    job = partial(fly, catalogue=arenas, iterations=MANY, seconds=few.seconds)
    found.append(_arena_table(_flown(job, points()[-len(SCENARIOS) :], few, alone=quick), few))
    job = partial(fly, catalogue=sizes, iterations=BUDGETS[0], seconds=extent.seconds)
    found.append(_sizes_table(_flown(job, points("mixed"), extent, alone=quick), extent.said(quick=quick)))
    return found


def arenas() -> tuple[Form, ...]:
    """Return paper mode with its arena, and with one that is never full."""
    return (
        Form(f"an arena of {PAPER.max_nodes:,} nodes", _as_it_is()),
        Form("→ no bound", _as_it_is(SearchSettings(search="paper", max_nodes=UNBOUNDED))),
    )


def sizes() -> tuple[Form, ...]:
    """Return paper mode as it is, and one that never sends a message that exceeds a limit."""
    return Form("sent in a longer window", _as_it_is()), Form("→ never sent", _literal(stretched=False))


def fly(
    place: tuple[Point, int], *, catalogue: Callable[[], Sequence[Form]], iterations: int, seconds: float
) -> list[Flight]:
    """Fly the mission of a point and a seed with the forms of a catalogue.

    Raises RuleBrokenError when one breaks a constraint, OracleUnavailable without SciPy.
    """
    point, seed = place
    flown = point.mission(seed, seconds)
    bound = upper_bound(flown).bound
    first = seed == 0 and iterations == BUDGETS[0]
    return [
        Flight(point, seed, form.name, utility(flown, form.fly(flown, iterations)) / bound)
        for form in catalogue()
        if first or not form.slow
    ]


def _flown(
    job: Callable[[tuple[Point, int]], list[Flight]], where: Sequence[Point], extent: Extent, *, alone: bool
) -> list[Flight]:
    return [one for of_mission in on_all_cores(job, extent.places(where), alone=alone) for one in of_mission]


def _by_form(flown: Sequence[Flight]) -> dict[str, list[Flight]]:
    return {name: [one for one in flown if one.form == name] for name in dict.fromkeys(one.form for one in flown)}


def _more(first: Sequence[Flight], own: Sequence[Flight]) -> Mean:
    """Return by how much the first is ahead in the missions that the other flew."""
    shares = {(one.point, one.seed): one.share for one in first}
    return Mean.of([shares[one.point, one.seed] - one.share for one in own])


def _worth_table(flown: Sequence[Flight], budget: int, said: str) -> Table:
    known = _by_form(flown)
    first = next(iter(known.values()))
    return Table(
        f"What each deviation is worth, {budget:,} iterations",
        ("what paper mode does → what the paper says", "the paper's", "worth", *(s.name for s in SCENARIOS)),
        tuple(_worth_rows(known, first)),
        "Share of the offline bound [%] with what the paper says, and what doing otherwise is worth: how far paper mode"
        f" as it is is ahead [points], with the 95 % confidence interval of the mean over missions; {said},"
        f" latency 10 ms, horizon {HORIZON}, forecasts from periods and means, one central decider. A new child and the"
        " descendants' mean are in the Python engine alone and flew one mission a point. No constraint was broken.",
    )


def _worth_rows(known: dict[str, list[Flight]], first: Sequence[Flight]) -> Iterator[tuple[str, ...]]:
    for name, own in known.items():
        share = f"{100 * fmean(one.share for one in own):.2f}"
        if own == first:
            yield name, share, "", *(f"{100 * fmean(_shares(own, n)):.2f}" for n in range(len(SCENARIOS)))
            continue
        each = (_more(_of_scenario(first, n), _of_scenario(own, n)).percent(2) for n in range(len(SCENARIOS)))
        yield name, share, _more(first, own).percent(2), *each


def _of_scenario(flown: Sequence[Flight], scenario: int) -> list[Flight]:
    return [one for one in flown if one.point.scenario == scenario]


def _shares(flown: Sequence[Flight], scenario: int) -> list[float]:
    return [one.share for one in _of_scenario(flown, scenario)]


def _arena_table(flown: Sequence[Flight], extent: Extent) -> Table:
    bounded, free = _by_form(flown).values()
    rows = [
        (own[0].form, *(f"{100 * fmean(_shares(own, n)):.2f}" for n in range(len(SCENARIOS))))
        for own in (bounded, free)
    ]
    return Table(
        f"The arena, {MANY:,} iterations",
        ("form", *(scenario.name for scenario in SCENARIOS)),
        tuple(rows),
        f"Share of the offline bound [%]; {extent.missions()} of each scenario at {flown[0].point.limit_name()}. The"
        f" bound on nodes is worth {_more(bounded, free).percent(2)} points."
        f" An iteration makes two nodes at most: up to {PAPER.max_nodes // 2:,} iterations the arena changes nothing.",
    )


def _sizes_table(flown: Sequence[Flight], said: str) -> Table:
    rows = []
    for limit in dict.fromkeys(one.point.limit_name() for one in flown):
        stretched, dropped = _by_form([one for one in flown if one.point.limit_name() == limit]).values()
        shares = (f"{100 * fmean(one.share for one in own):.2f}" for own in (stretched, dropped))
        rows.append((limit, *shares, _more(stretched, dropped).percent(2)))
    return Table(
        f"Messages larger than a limit, {BUDGETS[0]} iterations",
        ("limit", "sent in a longer window", "never sent (Eq. 5)", "worth"),
        tuple(rows),
        "Share of the offline bound [%], which sends them in a longer window, too, and what sending them is worth"
        f" [points]; missions of mixed sizes, 0.2 to 50 kB; {said}.",
    )
