"""What all designs have in common."""

import pytest

from planner import SearchSettings, start
from planner.tables import tabulate
from studies.designs.ablations import Best
from studies.designs.design import Design, worth
from tests.planner.windows import open_messages, window


def test_a_decider_decides_by_the_plan_and_counts():
    """It says what the planner says, and adds up iterations and plans over decisions."""
    decider = Design("best", lambda: lambda problem: Best(tabulate(problem, beyond=True)), 40).decider()
    total = 0
    for seed in range(10):
        problem = window(seed)
        known = start(problem, SearchSettings())
        total += known.run(40)
        assert decider.decide(problem) == known.plan().send
    assert (decider.decisions, decider.iterations) == (10, total)
    assert decider.plans >= decider.decisions


def test_worth_is_what_a_plan_adds_to_the_facts():
    """As the planner reckons it."""
    for seed in range(10):
        problem = window(seed)
        tables = tabulate(problem)
        plan = start(problem, SearchSettings(search="paper")).plan()
        assert worth(tables, []) == 0.0
        assert plan.utility == pytest.approx(tables.gains.facts)
        found = start(problem, SearchSettings(search="best"))
        found.run(50)
        levels = [open_messages(problem).index(message) for message in found.plan().sends]
        assert tables.gains.facts + worth(tables, levels) == pytest.approx(found.plan().utility)
