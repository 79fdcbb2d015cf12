"""The paper's search with the maximum in place of the mean."""

import pytest

from planner import SearchSettings, start
from planner.python_engine.tree import Node, subtree
from planner.tables import tabulate
from studies.designs.paper import MaximumBackup, Paper
from tests.planner.windows import open_messages, stale_window, window

REDUCTIONS = ("off", "paper", "exact")


@pytest.mark.parametrize("reduction", REDUCTIONS)
def test_with_the_mean_it_is_paper_mode(reduction):
    """The same plan as the planner's."""
    settings = SearchSettings(search="paper", reduction=reduction)
    for seed in range(10):
        problem = window(seed)
        known, search = start(problem, settings), Paper(tabulate(problem), settings)
        known.run(200)
        search.run(200)
        assert [open_messages(problem)[level] for level in search.sends()] == list(known.plan().sends)


@pytest.mark.parametrize("reduction", REDUCTIONS)
@pytest.mark.parametrize("draw", [window, stale_window])
def test_a_node_scores_what_its_best_leaf_scores(reduction, draw):
    """Whatever the reduction cut or moved, scores are those of the tree that is left."""
    for seed in range(15):
        search = MaximumBackup(tabulate(draw(seed)), SearchSettings(search="paper", reduction=reduction))
        search.run(150)
        for node in subtree(search._root):
            if node.visits:
                assert search._top[node.index] == pytest.approx(best_leaf(search, node))


def best_leaf(search: MaximumBackup, node: Node) -> float:
    children = [child for child in node.living_children() if child.visits]
    if not children:
        return node.utility / search._scale[node.level]
    return max(best_leaf(search, child) for child in children)
