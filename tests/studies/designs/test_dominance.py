"""Best mode with true dominance."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import Aggregation
from planner.tables import tabulate
from studies.designs.ablations import Best
from studies.designs.design import worth
from studies.designs.dominance import TrueDominance, open_windows
from tests.planner.windows import optimum, window


@pytest.mark.full
@given(st.integers(0, 10_000), st.booleans(), st.integers(0, 3))
def test_true_dominance_never_changes_the_optimum(seed, grid, constraints):
    """What is left out is no better than what stays: the search proves the best plan of the window."""
    kinds = (Aggregation.MOST_RECENT, Aggregation.SUM, Aggregation.ONCE)
    problem = window(seed, horizon=6, constraints=constraints, grid=grid, goes_on=False, aggregations=kinds)
    search = TrueDominance(tabulate(problem, beyond=True))
    search.run(100_000)
    assert search.proven
    reached = search.tables.gains.aim_facts + worth(search.tables, search.sends())
    assert reached == pytest.approx(optimum(problem)[0])


def test_it_drops_more_than_equality_does():
    """Over many windows with messages of many sizes it needs fewer nodes to prove the best plan."""
    nodes = {Best: 0, TrueDominance: 0}
    for seed in range(20):
        for kind in nodes:
            search = kind(tabulate(window(seed, horizon=14), beyond=True))
            search.run(100_000)
            nodes[kind] += len(search.tree())
    assert nodes[TrueDominance] < nodes[Best]


def test_open_windows_hold_what_was_decided_and_end_later():
    """After the last level nothing is to be checked any more."""
    tables = tabulate(window(3))
    windows = open_windows(tables)
    assert windows[-1] == []
    for level, pairs in enumerate(windows):
        assert all(first <= level for _, first in pairs)
        later = set(tables.checks.first[tables.checks.start[level + 1] :].tolist())
        assert {first for _, first in pairs} == {first for first in later if first <= level}
