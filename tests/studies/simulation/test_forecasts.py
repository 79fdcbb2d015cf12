"""The probe of forecasts."""

import pytest

from studies.simulation.conditions import Conditions
from studies.simulation.flights import team
from studies.simulation.forecasts import Errors, Probe
from studies.simulation.missions import draw
from studies.workload import MIXED, MOST_IMPORTANT


def probe(scenario, **changes):
    """Fly three robots, and ask them what they expect."""
    how = Conditions(robots=3, limit=2, seconds=10.0, iterations=50, **changes)
    flown, probe = draw(scenario, 0, how), Probe()
    flying = team(flown, how, 0)
    probe.attach(flying, flown.frames)
    flying.run(flown.frames, flown.problem.t_end)
    return probe


def test_a_clockwork_is_foreseen_by_its_own_robot():
    """Nearly to the microsecond, whatever its clock shows."""
    assert max(probe(MOST_IMPORTANT).own.summary()) < 1e-3


def test_what_nobody_told_of_is_not_foreseen():
    """It counts as the largest error there can be."""
    lost = probe(MIXED, loss=1.0)
    assert lost.others.summary() == (0.5, 0.5)
    assert lost.others.none > 0 == lost.own.none


def test_errors_have_a_median_and_a_tail():
    """Of nothing they are the largest."""
    median, tail = Errors([0.01 * i for i in range(21)]).summary()
    assert median == pytest.approx(0.1)
    assert 0.19 <= tail <= 0.21
    assert Errors().summary() == (0.5, 0.5)
