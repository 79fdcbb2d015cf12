"""Both engines grow the same tree and give the same answer."""

import dataclasses
import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import Aggregation, Search, SearchSettings, start
from tests.planner.windows import MARKOVIAN, stale_window, window
from tests.seeds import seeds

REDUCTIONS = ("off", "paper", "exact")
CURRENT = (Aggregation.CURRENT,) * 2
"""Twice, for several receivers and newest samples that are no message."""


def both(problem, settings) -> tuple[Search, Search]:
    return tuple(start(problem, dataclasses.replace(settings, engine=engine)) for engine in ("python", "native"))


def drawn(seed: int, aggregations=MARKOVIAN):
    """A window of its own size, number of constraints and roundness for every seed."""
    return window(
        seed,
        robots=1 + seed % 5,
        horizon=4 + seed % 13,
        constraints=seed % 3,
        grid=seed % 2 == 0,
        aggregations=aggregations,
    )


@pytest.mark.parametrize("reduction", REDUCTIONS)
@pytest.mark.parametrize("block", seeds(4, 1))
def test_same_tree_in_paper_mode(reduction, block):
    """Paper mode grows the same tree node by node on either engine, whatever the reduction."""
    for seed in range(30 * block, 30 * block + 30):
        python, native = both(drawn(seed), SearchSettings(search="paper", reduction=reduction))
        for _ in range(2):
            assert python.run(60) == native.run(60)
            assert python.tree() == native.tree()
            assert python.plan() == native.plan()


@pytest.mark.parametrize(("reduction", "exploration"), list(itertools.product(REDUCTIONS[1:], (0.35, 0.6))))
@pytest.mark.parametrize("block", seeds(4, 1))
def test_same_tree_while_subtrees_move(reduction, exploration, block):
    """Also where better nodes take over what grew below tantamount ones, the trees stay the same."""
    for seed in range(25 * block, 25 * block + 25):
        settings = SearchSettings(search="paper", reduction=reduction, exploration=exploration)
        python, native = both(stale_window(seed), settings)
        python.run(200), native.run(200)
        assert python.tree() == native.tree()
        assert python.plan() == native.plan()


@given(
    st.integers(0, 2**32),
    st.sampled_from([("best", "off"), *(("paper", reduction) for reduction in REDUCTIONS)]),
    st.sampled_from([MARKOVIAN, tuple(Aggregation), (Aggregation.BEST, Aggregation.ONCE), (Aggregation.SUM,), CURRENT]),
)
def test_same_tree_on_any_window(seed, mode, aggregations):
    """Whatever the window, the mode and the aggregations."""
    python, native = both(drawn(seed, aggregations), SearchSettings(search=mode[0], reduction=mode[1]))
    assert python.run(170) == native.run(170)
    assert python.tree() == native.tree()
    assert python.plan() == native.plan()


@pytest.mark.parametrize("block", seeds(6, 1))
def test_same_tree_in_best_mode(block):
    """The default mode grows the same tree node by node on either engine, with arenas small and large."""
    trees = 0
    for seed in range(10 * block, 10 * block + 10):
        problem = window(seed, robots=4 + seed % 5, horizon=26 + seed % 9, constraints=1 + seed % 3, grid=seed % 4 == 0)
        python, native = both(problem, SearchSettings(max_nodes=(65_536, 1, 7, 60)[seed % 4]))
        for iterations in (0, 1, 99, 12, 60, 150):
            assert python.run(iterations) == native.run(iterations)
            assert python.tree() == native.tree()
            assert python.plan() == native.plan()
            assert python.done == native.done
        trees += len(python.tree()) > 0
    assert trees >= 2


@pytest.mark.parametrize("mode", [("best", "off"), *(("paper", reduction) for reduction in REDUCTIONS)])
@pytest.mark.parametrize("block", seeds(3, 1))
def test_same_tree_whatever_the_aggregation(mode, block):
    """All aggregations, side by side and with several receivers, give the same tree on either engine."""
    for seed in range(20 * block, 20 * block + 20):
        settings = SearchSettings(search=mode[0], reduction=mode[1])
        python, native = both(drawn(seed, tuple(Aggregation)), settings)
        for iterations in (1, 20, 120):
            assert python.run(iterations) == native.run(iterations)
            assert python.tree() == native.tree()
            assert python.plan() == native.plan()


def test_same_tree_on_a_full_window():
    """A window of a decision in flight, ten robots and sixty messages, gives the same tree on either engine."""
    for seed, mode in itertools.product(range(2), ("best", "paper")):
        python, native = both(window(seed, robots=10, horizon=60, constraints=2), SearchSettings(search=mode))
        assert python.run(260) == native.run(260)
        assert python.tree() == native.tree()
        assert python.tree()
        assert python.plan() == native.plan()


@pytest.mark.parametrize("mode", ["best", "paper"])
def test_seed_and_slices_change_nothing(mode):
    """The tree depends on the problem and the number of iterations only, not on how they were cut into runs."""
    for engine in ("python", "native"):
        settings = SearchSettings(search=mode, engine=engine)
        whole, sliced = start(drawn(8), settings, seed=1), start(drawn(8), settings, seed=1)
        whole.run(40)
        for _ in range(40):
            sliced.run(1)
        assert whole.tree() == sliced.tree()
        assert whole.plan() == sliced.plan()
