"""Prices bound every plan from above and make a good policy."""

import pytest

from planner import SearchSettings
from planner.python_engine.best import BestSearch
from planner.tables import tabulate
from tests.planner.windows import objective, optimum, window


def learned(problem, iterations=1, *, beyond=False):
    search = BestSearch(tabulate(problem, beyond=beyond), SearchSettings())
    search.run(iterations)
    return search


@pytest.mark.parametrize("seed", range(40))
def test_bound_is_never_below_the_optimum(seed):
    """The relaxed optimum, and what each node may still promise, bound the best of all subsets."""
    problem = window(seed, robots=1 + seed % 4, horizon=7, constraints=seed % 4, grid=seed % 2 == 0)
    best = optimum(problem)[0]
    search = learned(problem)
    bound = search.tree()[0][4]
    assert bound >= best - 1e-9 * abs(best) - 1e-12
    found = search.plan().utility
    assert max(found, search.tree()[0][6]) >= best - 1e-8 * abs(best)


@pytest.mark.parametrize("seed", range(40))
def test_bound_holds_beyond_the_window(seed):
    """Also with what is left behind no subset is worth more than the bound."""
    problem = window(seed, robots=1 + seed % 4, horizon=7, constraints=seed % 4, grid=seed % 2 == 0)
    best = optimum(problem, objective)[0]
    assert learned(problem, beyond=True).tree()[0][4] >= best - 1e-9 * abs(best) - 1e-12


def test_bound_is_the_optimum_when_nothing_binds():
    """Without constraints the first iteration is proven optimal."""
    for seed in range(10):
        problem = window(seed, robots=3, horizon=8, constraints=0)
        search = learned(problem)
        assert search.done
        assert search.plan().utility == pytest.approx(optimum(problem)[0])


def test_policy_alone_loses_little():
    """Summed over windows, the first iteration's plan is within three per cent of the optimum."""
    found = best = 0.0
    for seed in range(40):
        problem = window(seed, robots=4, horizon=8, constraints=1)
        found += learned(problem).plan().utility
        best += optimum(problem)[0]
    assert found >= 0.97 * best
