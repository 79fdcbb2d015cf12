"""All designs, as the benchmark names them."""

import pytest

from planner.constraints import violations
from studies.central import CentralDecider
from studies.designs.catalogue import catalogue
from studies.designs.design import worth
from studies.workload import SCENARIOS, mission
from tests.planner.windows import objective, objectives, open_messages, optimum, window

DESIGNS = list(catalogue())
WINDOWS = [window(seed, horizon=7, constraints=1 + seed % 2) for seed in range(10)]


def test_names_are_told_apart():
    """The tables know designs by name."""
    assert len({design.name for design in DESIGNS}) == len(DESIGNS)


@pytest.mark.full
@pytest.mark.parametrize("design", DESIGNS, ids=lambda design: design.name)
def test_designs_fly_within_the_constraints(design):
    """On a mission of every scenario each design sends something, breaks nothing and counts what it did."""
    for scenario in SCENARIOS:
        flown, decider = mission(scenario, seed=4, seconds=1.5), design.decider()
        sends = CentralDecider(flown, horizon=8).fly(decider.decide)
        assert sends
        assert violations(flown, sends) == []
        assert decider.decisions == len(flown.messages)
        assert decider.iterations >= decider.decisions
        assert decider.plans > 0


@pytest.fixture(scope="module")
def optima():
    """What the best plan of each window is worth."""
    return [optimum(problem, objectives)[0] for problem in WINDOWS]


@pytest.mark.parametrize("design", DESIGNS, ids=lambda design: design.name)
def test_no_plan_beats_the_optimum_or_breaks_a_constraint(design, optima):
    """The plan that a design answers with fits, and is worth no more than the best of all."""
    for problem, best in zip(WINDOWS, optima, strict=True):
        search = design.decider().search(problem)
        sends = [open_messages(problem)[level] for level in search.sends()]
        assert violations(problem, sends) == []
        if search.tables.beyond is not None:
            reached = search.tables.gains.aim_facts + worth(search.tables, search.sends())
            assert reached == pytest.approx(objective(problem, sends))
            assert reached <= best + 1e-9
