"""Prices bound every plan from above and make a good policy."""

import pytest

from planner import SearchSettings
from planner.python_engine.best import BestSearch
from planner.tables import tabulate
from tests.planner.windows import objectives, optimum, window
from tests.seeds import seeds


def learned(problem, iterations=1, *, beyond=False):
    search = BestSearch(tabulate(problem, beyond=beyond), SearchSettings())
    search.run(iterations)
    return search


def learning(problem, *, beyond=False):
    """The search after its first iteration, in the midst of learning, with all prices, and some way on."""
    search = BestSearch(tabulate(problem, beyond=beyond), SearchSettings())
    for iterations in (1, 9, 90, 40):
        search.run(iterations)
        yield search


@pytest.mark.parametrize("seed", seeds(40))
def test_bound_is_never_below_the_optimum(seed):
    """At any time the plan and what may still be gained bound the best of all subsets."""
    problem = window(seed, robots=1 + seed % 4, horizon=7, constraints=seed % 4, grid=seed % 2 == 0)
    best = optimum(problem)[0]
    for search in learning(problem):
        plan = search.plan()
        assert plan.utility + plan.gap >= best - 1e-8 * abs(best) - 1e-12


@pytest.mark.parametrize("seed", seeds(40))
def test_bound_holds_beyond_the_window(seed):
    """Also with what is left behind no subset is worth more than the bound."""
    problem = window(seed, robots=1 + seed % 4, horizon=7, constraints=seed % 4, grid=seed % 2 == 0)
    best, value = optimum(problem, objectives)[0], objectives(problem)
    for search in learning(problem, beyond=True):
        plan = search.plan()
        assert value(plan.sends) + plan.gap >= best - 1e-8 * abs(best) - 1e-12


def test_bound_is_the_optimum_when_nothing_binds():
    """Without constraints the first iteration is proven optimal."""
    for seed in range(10):
        problem = window(seed, robots=3, horizon=8, constraints=0)
        search = learned(problem)
        assert search.done
        assert search.plan().utility == pytest.approx(optimum(problem)[0])
        assert search.plan().gap == pytest.approx(0.0, abs=1e-9)


def test_policy_alone_loses_little():
    """Summed over windows, what is found while the prices are learned is within one per cent of the optimum."""
    found = best = 0.0
    for seed in range(40):
        problem = window(seed, robots=4, horizon=8, constraints=1)
        found += learned(problem, 100).plan().utility
        best += optimum(problem)[0]
    assert found >= 0.99 * best
