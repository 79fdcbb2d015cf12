"""What a search answers with: utilities by the definition, and what speaks for the decision."""

from dataclasses import replace

import pytest

from planner import Constraint, Linear, Message, Problem, SearchSettings, Stream, Traffic, start
from planner.answers import Found, answer
from planner.definition import utility
from planner.tables import tabulate
from tests.planner.windows import objective, open_messages, window
from tests.seeds import seeds


@pytest.mark.parametrize("seed", seeds(20))
def test_plan_is_weighed_by_utility_and_its_lead_by_the_objective(seed):
    """`utility` and `opposite` are U; `lead` counts what is left behind, too."""
    problem = window(seed, robots=3, horizon=8, constraints=seed % 3)
    tables, opened = tabulate(problem, beyond=True), open_messages(problem)
    sends, opposite = [1, 2, tables.current], [0, 3]
    sends = sorted(set(sends))
    opposite = [level for level in opposite if level != tables.current]
    plan = answer(
        tables, Found(sends, opposite, bound=1e9, asked=(0.0,) * len(tables.checks.constraint), nodes=9), iterations=7
    )
    taken, other = [opened[level] for level in sends], [opened[level] for level in opposite]
    assert (plan.send, plan.sends, plan.iterations, plan.nodes) == (True, tuple(taken), 7, 9)
    assert plan.utility == pytest.approx(utility(problem, taken))
    assert plan.opposite == pytest.approx(utility(problem, other))
    assert plan.lead == pytest.approx(objective(problem, taken) - objective(problem, other), abs=1e-9)
    assert plan.gap == pytest.approx(1e9 - objective(problem, taken))
    without = [at for at in taken if at != problem.current]
    assert plan.earns == pytest.approx(objective(problem, taken) - objective(problem, without), abs=1e-9)
    assert plan.spared == pytest.approx(utility(problem, without))


def test_plan_without_an_opposite_has_no_lead():
    """Nothing speaks against a decision that was never in question."""
    plan = answer(tabulate(window(1)), Found([], None, bound=None, asked=(0.0,), nodes=0), iterations=0)
    assert (plan.send, plan.opposite, plan.lead, plan.gap) == (False, None, None, None)


@pytest.mark.parametrize("seed", seeds(20))
def test_what_a_message_earns_is_told_of_the_plan_that_sends_it(seed):
    """Also where the plan drops it; nothing where no plan is known that sends it."""
    problem = window(seed, robots=3, horizon=8, constraints=seed % 3)
    tables, opened = tabulate(problem, beyond=True), open_messages(problem)
    others = [level for level in (1, 2) if level != tables.current]
    asked = (0.0,) * len(tables.checks.constraint)
    plan = answer(tables, Found(others, sorted([*others, tables.current]), None, asked, 1), iterations=1)
    rest = [opened[level] for level in others]
    earned = objective(problem, sorted([*rest, problem.current])) - objective(problem, rest)
    assert not plan.send
    assert plan.earns == pytest.approx(earned, abs=1e-9)
    assert (plan.earns, plan.spared) == pytest.approx((-plan.lead, plan.utility), abs=1e-9)
    assert answer(tables, Found(others, None, None, asked, 1), iterations=1).earns is None


@pytest.mark.parametrize("engine", ["native", "python"])
def test_lead_of_paper_mode_is_the_difference_of_utilities(engine):
    """It maximises nothing else."""
    search = start(window(5, robots=3, horizon=6, constraints=0), SearchSettings(search="paper", engine=engine))
    search.run(1000)
    plan = search.plan()
    assert plan.opposite is not None
    assert plan.lead == plan.utility - plan.opposite


def crowded(first, second):
    """Two streams, of which a constraint lets one send."""
    messages = (
        Message(0, 0.0, 0.0, 0.0, Linear(1.0, 0.1), first, (1.0, 0.0)),
        Message(1, 0.1, 0.1, 0.1, Linear(1.0, 0.1), second, (1.0, 0.0)),
    )
    limits = (Constraint("channel", 1.0, 1.0), Constraint("battery", 1.0, 1.0))
    return Problem((Stream(0), Stream(1)), messages, 0, limits, (), -1.0, 5.0, goes_on=False)


@pytest.mark.parametrize("engine", ["native", "python"])
@pytest.mark.parametrize("mode", ["best", "paper"])
def test_decision_names_the_constraint_that_binds(engine, mode):
    """It is the one that both messages want; what it asks lies between what the two are worth."""
    for first, second in ((1.0, 3.0), (3.0, 1.0)):
        search = start(crowded(first, second), SearchSettings(search=mode, engine=engine))
        search.run(300)
        plan = search.plan()
        assert plan.send == (first > second)
        assert plan.binding == ("channel",)
        assert plan.prices[1] == 0.0
        assert plan.gap == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("engine", ["native", "python"])
def test_nothing_binds_where_there_is_room(engine):
    """A message that is not worth anything is dropped for that alone."""
    search = start(crowded(0.0, 0.0), SearchSettings(engine=engine))
    search.run(300)
    plan = search.plan()
    assert (plan.send, plan.binding, plan.prices) == (False, (), (0.0, 0.0))


@pytest.mark.parametrize("engine", ["native", "python"])
def test_full_channel_binds_without_a_price(engine):
    """A message that finds no room beside what was sent names what keeps it out."""
    problem = crowded(1.0, 0.0)
    problem = replace(problem, traffic=(Traffic(-0.5, (1.0, 0.0)),))
    search = start(problem, SearchSettings(engine=engine))
    search.run(300)
    assert (search.plan().send, search.plan().binding) == (False, ("channel",))
