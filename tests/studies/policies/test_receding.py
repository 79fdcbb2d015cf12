"""The exact receding-horizon optimiser against the oracle."""

import pytest

from planner import Constraint
from planner.definition import utility
from studies.central import CentralDecider
from studies.oracle import optimum
from studies.policies import Receding
from studies.workload import MIXED, MOST_IMPORTANT, mission

LIMIT = Constraint("messages", 2.5, 5.0)


@pytest.mark.full
@pytest.mark.parametrize("budget", [1, 100_000])
def test_a_mission_within_the_horizon_is_flown_optimally(budget):
    """Of a mission that one window holds it finds the integer optimum, by the search and by HiGHS alike."""
    flown = mission(MOST_IMPORTANT, seed=1, seconds=5.0, constraint=LIMIT)
    policy = Receding(beyond=False, budget=budget)
    sends = CentralDecider(flown, 100).fly(policy)
    assert utility(flown, sends) == pytest.approx(optimum(flown).utility)
    assert policy.unproven == 0


def test_windows_without_proof_are_counted():
    """Without iterations for a proof, and without HiGHS for the objective, nothing is proven."""
    flown = mission(MOST_IMPORTANT, seed=1, seconds=15.0, constraint=LIMIT)
    hasty, thorough = Receding(budget=1), Receding()
    for policy in (hasty, thorough):
        CentralDecider(flown, 60).fly(policy)
    assert hasty.unproven > 0
    assert thorough.unproven == 0


def test_the_channel_is_used_up_when_nothing_lies_beyond():
    """The two objectives are not the same: one of them charges what reaches over the window's end."""
    flown = mission(MIXED, seed=1, seconds=30.0, constraint=LIMIT)
    both = [CentralDecider(flown, 20).fly(Receding(beyond=beyond)) for beyond in (True, False)]
    assert both[0] != both[1]
    assert utility(flown, both[0]) > utility(flown, both[1])
