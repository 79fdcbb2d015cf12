"""Best mode with one part left out."""

import pytest

from planner import SearchSettings, start
from planner.tables import tabulate
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
from studies.designs.design import worth
from tests.planner.windows import objectives, open_messages, optimum, window

WINDOWS = [window(seed, horizon=7, constraints=1 + seed % 2) for seed in range(20)]
EXACT = {
    "as it is": Best,
    "without learning": without_learning,
    "without dominance": WithoutDominance,
    "without the sweep": WithoutSweep,
    "few rounds": lambda tables: with_prices(tables, FewRounds, 5),
    "averaged": lambda tables: with_prices(tables, Averaged, 20),
    "deflected": lambda tables: with_prices(tables, Deflected, 20),
}


@pytest.fixture(scope="module")
def optima():
    """What the best plan of each window is worth."""
    return [optimum(problem, objectives)[0] for problem in WINDOWS]


def test_as_it_is_it_decides_what_the_planner_decides():
    """The same plan after the same iterations."""
    for problem in WINDOWS:
        known = start(problem, SearchSettings())
        search = Best(tabulate(problem, beyond=True))
        assert (search.run(40), search.done) == (known.run(40), known.done)
        assert [open_messages(problem)[level] for level in search.sends()] == list(known.plan().sends)


@pytest.mark.parametrize("name", EXACT)
def test_what_prunes_by_bounds_finds_the_optimum(name, optima):
    """Whatever is left out of learning or dominance costs time, not the proof."""
    for problem, best in zip(WINDOWS, optima, strict=True):
        search = EXACT[name](tabulate(problem, beyond=True))
        search.run(100_000)
        assert search.proven
        reached = search.tables.gains.aim_facts + worth(search.tables, search.sends())
        assert reached == pytest.approx(best)


@pytest.mark.parametrize(("design", "most"), [(LearningAlone, 100), (WithoutTree, 200)])
def test_without_the_tree_it_ends_before(design, most):
    """No node is ever created."""
    for problem in WINDOWS:
        search = design(tabulate(problem, beyond=True))
        search.run(1_000)
        assert search.done
        assert search.iterations <= most
        assert search.tree() == []


def test_without_learning_all_prices_are_zero():
    """One round, and nobody pays anything."""
    for problem in WINDOWS:
        search = without_learning(tabulate(problem, beyond=True))
        search.run(1)
        assert not search.prices.learning
        assert not any(search.prices.asked(search.tables.current))


def test_deflected_directions_bound_better():
    """Where many rows bind, the same rounds come closer to the least bound."""
    windows = [window(seed, robots=6, horizon=24) for seed in range(15)]
    bounds = {}
    for kind in (FewRounds, Deflected):
        searches = [with_prices(tabulate(problem, beyond=True), kind, 30) for problem in windows]
        for search in searches:
            search.run(30)
            assert not search.prices.learning
        bounds[kind] = sum(search.prices.bound for search in searches)
    assert bounds[Deflected] < bounds[FewRounds]


def test_without_dominance_no_node_is_removed():
    """It keeps what is tantamount, and more nodes altogether."""
    sizes = []
    for kind in (Best, WithoutDominance):
        searches = [kind(tabulate(window(seed, horizon=14, grid=True), beyond=True)) for seed in range(20)]
        for search in searches:
            search.run(300)
        sizes.append(sum(len(search.tree()) for search in searches))
    assert sizes[0] <= sizes[1]
