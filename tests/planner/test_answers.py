"""What a search answers with: utilities by the definition, and what speaks for the decision."""

import pytest

from planner import SearchSettings, start
from planner.answers import answer
from planner.evaluation import utility
from planner.tables import tabulate
from tests.planner.windows import objective, open_messages, window


@pytest.mark.parametrize("seed", range(20))
def test_plan_is_weighed_by_utility_and_its_lead_by_the_objective(seed):
    """`utility` and `opposite` are U; `lead` counts what is left behind, too."""
    problem = window(seed, robots=3, horizon=8, constraints=seed % 3)
    tables, opened = tabulate(problem, beyond=True), open_messages(problem)
    sends, opposite = [1, 2, tables.current], [0, 3]
    sends = sorted(set(sends))
    opposite = [level for level in opposite if level != tables.current]
    plan = answer(tables, sends, opposite, iterations=7, nodes=9)
    taken, other = [opened[level] for level in sends], [opened[level] for level in opposite]
    assert (plan.send, plan.sends, plan.iterations, plan.nodes) == (True, tuple(taken), 7, 9)
    assert plan.utility == pytest.approx(utility(problem, taken))
    assert plan.opposite == pytest.approx(utility(problem, other))
    assert plan.lead == pytest.approx(objective(problem, taken) - objective(problem, other), abs=1e-9)


def test_plan_without_an_opposite_has_no_lead():
    """Nothing speaks against a decision that was never in question."""
    plan = answer(tabulate(window(1)), [], None, iterations=0, nodes=0)
    assert (plan.send, plan.opposite, plan.lead) == (False, None, None)


@pytest.mark.parametrize("engine", ["native", "python"])
def test_lead_of_paper_mode_is_the_difference_of_utilities(engine):
    """It maximises nothing else."""
    search = start(window(5, robots=3, horizon=6, constraints=0), SearchSettings(search="paper", engine=engine))
    search.run(1000)
    plan = search.plan()
    assert plan.opposite is not None
    assert plan.lead == plan.utility - plan.opposite
