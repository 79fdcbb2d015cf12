"""UCT with roll-outs."""

import pytest

from planner.tables import tabulate
from studies.designs.design import worth
from studies.designs.rollouts import ByAdvantage, ByGainPerUse, CompletedUct
from tests.planner.windows import objectives, optimum, window

POLICIES = (ByGainPerUse, ByAdvantage)


@pytest.mark.full
@pytest.mark.parametrize("policy", POLICIES)
def test_it_finds_the_optimum_of_small_windows(policy):
    """With time enough to try all that is worth it."""
    for seed in range(15):
        problem = window(seed, horizon=5, constraints=1 + seed % 2)
        search = CompletedUct(tabulate(problem, beyond=True), policy, 0.35)
        search.run(1_500)
        reached = search.tables.gains.aim_facts + worth(search.tables, search.sends())
        assert reached == pytest.approx(optimum(problem, objectives)[0])


@pytest.mark.parametrize("policy", POLICIES)
def test_every_iteration_completes_a_plan_and_none_is_forgotten(policy):
    """More iterations never give a worse plan."""
    search = CompletedUct(tabulate(window(5, horizon=12), beyond=True), policy, 0.35)
    values = []
    for _ in range(40):
        search.run(5)
        values.append(worth(search.tables, search.sends()))
    assert search.plans == search.iterations == 200
    assert values == sorted(values)
