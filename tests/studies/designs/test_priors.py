"""Best mode that begins with what the last decision found."""

from itertools import pairwise

import pytest

from planner.tables import tabulate
from studies.benchmarks.designs import consecutive
from studies.designs.ablations import Best
from studies.designs.design import worth
from studies.designs.priors import Continuing, name
from studies.workload import MOST_IMPORTANT, mission

WINDOWS = list(consecutive(mission(MOST_IMPORTANT, 2, seconds=12.0), 25, begin=40, count=12))


def test_last_prices_and_plan_save_rounds():
    """Over consecutive windows the search is done sooner, and its plans are as good."""
    begin, cold, warm = Continuing(100, plan=True), 0, 0
    for problem in WINDOWS:
        alone, continued = Best(tabulate(problem, beyond=True)), begin(problem)
        for search in (alone, continued):
            search.run(5_000)
            assert search.proven
        assert worth(continued.tables, continued.sends()) == pytest.approx(worth(alone.tables, alone.sends()))
        cold, warm = cold + alone.iterations, warm + continued.iterations
    assert warm < cold


def test_the_last_plan_is_the_first_incumbent():
    """After one iteration a plan is worth at least what remains of the last one."""
    begin, before = Continuing(100, prices=False, plan=True), None
    for problem in WINDOWS:
        search = begin(problem)
        search.run(1)
        if before is not None:
            old = {name(before.tables, level) for level in before.sends()}
            kept = [level for level in range(search.tables.levels) if name(search.tables, level) in old]
            assert worth(search.tables, search.sends()) >= worth(search.tables, kept) - 1e-9
        search.run(300)
        before = search


def test_prices_are_those_of_the_rows_of_the_last_window():
    """A message that ends a row in both windows is asked the same before the first round."""
    begin, seen = Continuing(100), 0
    for first, second in pairwise(WINDOWS):
        search = begin(first)
        search.run(300)
        old = search.prices.multipliers()
        new = begin(second).prices.multipliers()
        assert all(price == old.get(row, 0.0) for row, price in new.items())
        seen += sum(price > 0 for price in new.values())
    assert seen > 0
