"""All designs by name."""

from collections.abc import Callable, Iterator
from typing import Literal

from planner import Problem, SearchSettings
from planner.tables import Tables, tabulate
from studies.designs.ablations import (
    Averaged,
    Best,
    Deflected,
    FewRounds,
    LearningAlone,
    WithoutDominance,
    WithoutSweep,
    WithoutTree,
    with_prices,
    without_learning,
)
from studies.designs.beam import Beam, WideningBeam
from studies.designs.design import Design, Sought
from studies.designs.dominance import TrueDominance
from studies.designs.paper import MaximumBackup, Paper
from studies.designs.priors import Continuing, KnownDeflected, KnownPrices
from studies.designs.rollouts import ByAdvantage, ByGainPerUse, CompletedUct

BUDGET = 300
"""Iterations of a decision."""

UNTIL_DONE = 100_000
"""More iterations than any beam takes."""

EXPLORATION = 0.35
"""c of Eq. 3."""

AS_IT_IS = "best mode"


def catalogue() -> Iterator[Design]:
    """Return all designs, families together."""
    yield from _paper()
    yield from _rollouts()
    yield from _beams()
    yield from _best()
    yield from _priors()


def _paper() -> Iterator[Design]:
    reductions: tuple[Literal["off", "paper", "exact"], ...] = ("off", "paper", "exact")
    for backup, search in (("mean", Paper), ("maximum", MaximumBackup)):
        for reduction in reductions:
            name = f"paper, {backup}" if reduction == "off" else f"paper, {backup}, {reduction} reduction"
            yield _design(name, _paper_start(search, reduction), beyond=False)


def _paper_start(search: type[Paper], reduction: Literal["off", "paper", "exact"]) -> Callable[[Tables], Sought]:
    settings = SearchSettings(search="paper", reduction=reduction, exploration=EXPLORATION)
    return lambda tables: search(tables, settings)


def _rollouts() -> Iterator[Design]:
    yield _design("UCT, completed by gain per use", lambda t: CompletedUct(t, ByGainPerUse, EXPLORATION))
    yield _design("UCT, completed by advantage", lambda t: CompletedUct(t, ByAdvantage, EXPLORATION))


def _beams() -> Iterator[Design]:
    for by_bound, rank in ((False, "value"), (True, "bound")):
        for width in (10, 50):
            yield _design(f"beam of {width} by {rank}", _beam_start(width, by_bound=by_bound), budget=UNTIL_DONE)
    for budget in (BUDGET, 3_000):
        yield _design(f"widening beam, 60 rounds, {budget:,} nodes", _widening, budget=budget)


def _widening(tables: Tables) -> Sought:
    return WideningBeam(tables, width=10, factor=4, rounds=60)


def _beam_start(width: int, *, by_bound: bool) -> Callable[[Tables], Sought]:
    return lambda tables: Beam(tables, width, by_bound=by_bound)


def _best() -> Iterator[Design]:
    yield _design(AS_IT_IS, Best)
    yield _design("best mode without learning", without_learning)
    yield _design("best mode without the tree", WithoutTree)
    yield _design("best mode without the sweep", WithoutSweep)
    yield _design("best mode, learning alone", LearningAlone)
    yield _design("best mode, sweep of 50", lambda tables: Best(tables, width=50))
    yield _design("best mode without dominance", WithoutDominance)
    yield _design("best mode without what lies beyond", Best, beyond=False)
    yield _design("best mode with true dominance", TrueDominance)
    yield _design("best mode, 30 rounds", lambda tables: with_prices(tables, FewRounds, 30))
    yield _design("best mode, averaged directions", lambda tables: with_prices(tables, Averaged, 100))
    yield _design("best mode, deflected directions", lambda tables: with_prices(tables, Deflected, 100))
    yield _design("best mode, deflected directions, 60 rounds", lambda tables: with_prices(tables, Deflected, 60))


def _priors() -> Iterator[Design]:
    yield Design("best mode, last plan", _continuing(100, prices=False, plan=True), BUDGET)
    yield Design("best mode, last prices", _continuing(100), BUDGET)
    yield Design("best mode, deflected directions, last prices", _continuing(100, kind=KnownDeflected), BUDGET)
    yield Design("best mode, last prices, 30 rounds", _continuing(30), BUDGET)
    yield Design("best mode, last prices and plan, 30 rounds", _continuing(30, plan=True), BUDGET)


def _continuing(
    rounds: int, *, prices: bool = True, plan: bool = False, kind: type[KnownPrices] = KnownPrices
) -> Callable[[], Continuing]:
    return lambda: Continuing(rounds, prices, plan, kind)


def _design(name: str, search: Callable[[Tables], Sought], *, beyond: bool = True, budget: int = BUDGET) -> Design:
    """Return a design that remembers nothing."""

    def start(window: Problem) -> Sought:
        return search(tabulate(window, beyond=beyond))

    return Design(name, lambda: start, budget)
