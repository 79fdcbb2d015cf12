"""The best plan of whole messages."""

import pytest

from planner.constraints import violations
from planner.definition import utility
from studies.oracle import optimum, upper_bound
from studies.simulation.scores import scored
from studies.simulation.traffic.missions import WARM_UP, draw
from studies.simulation.traffic.plan import best_plan, bound


@pytest.fixture(scope="module")
def mission():
    """Two robots for a few seconds."""
    return draw("mixed", 2, 1, WARM_UP + 3.0, latency=0.02)


@pytest.mark.full
def test_it_keeps_the_limit_and_is_worth_nearly_the_bound(mission):
    """With every small sample; its bytes are those after the warm-up."""
    problem = scored(mission.problem, WARM_UP)
    plan = best_plan(problem, certain=mission.small, since=WARM_UP, time_limit=20.0)
    assert not violations(mission.problem, plan.sends)
    assert mission.small <= set(plan.sends)
    assert plan.utility == pytest.approx(utility(problem, plan.sends))
    assert 0.0 <= plan.gap < 0.01
    images = [i for i in plan.sends if mission.frames[i].t_gen >= WARM_UP]
    assert plan.bytes == sum(mission.frames[i].size for i in images) > 0.7 * 3.0 * mission.limit / mission.window
    assert plan.seconds > plan.bounding > 0.0


@pytest.mark.full
def test_pieces_lose_little_beside_the_whole():
    """Of a mission that can be solved at once, with nothing certain."""
    mission = draw("random", 2, 0, 7.0, latency=0.02)
    whole = optimum(mission.problem, 30.0)
    plan = best_plan(mission.problem, time_limit=20.0)
    assert plan.utility >= 0.995 * whole.utility
    assert plan.bound == pytest.approx(upper_bound(mission.problem).bound)


def test_small_samples_would_be_sent_anyway(mission):
    """So the bound with all of them is that of the mission; with fewer windows it is a little higher."""
    problem = scored(mission.problem, WARM_UP)
    given = bound(problem, mission.small)
    assert given.bound == pytest.approx(upper_bound(problem).bound, rel=1e-4)
    assert all(given.sends[i] == 1.0 for i in mission.small)
    assert given.bound <= bound(problem, mission.small, 0.1).bound <= 1.05 * given.bound
