"""The quality benchmark: what it compares and what must hold whatever it measures."""

import pytest

from planner.constraints import violations
from studies.benchmarks import quality
from studies.benchmarks.quality import Candidate, RuleBrokenError, candidates, measure_mission
from studies.central import CentralDecider
from studies.workload import FEW_IMPORTANT, SCENARIOS, mission


@pytest.mark.full
@pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda scenario: scenario.name)
def test_no_policy_beats_the_oracle_or_breaks_a_constraint(scenario):
    """Every candidate stays within the constraint, below the integer optimum and the bound."""
    flown = mission(scenario, seed=11, seconds=6.0)
    for one in measure_mission(scenario, flown):
        assert one.proven
        assert 0 < one.reached <= one.optimum * (1 + 1e-9)
        assert one.optimum <= one.bound * (1 + 1e-6)
    for candidate in candidates():
        sends = CentralDecider(flown, candidate.horizon).fly(candidate.policy)
        assert violations(flown, sends) == []


def test_a_policy_that_breaks_a_constraint_is_not_measured(monkeypatch):
    """Its utility would mean nothing."""
    monkeypatch.setattr(quality, "candidates", lambda: [Candidate("send all", lambda _: True, 1)])
    with pytest.raises(RuleBrokenError, match="send all, few important"):
        list(measure_mission(FEW_IMPORTANT, mission(FEW_IMPORTANT, seed=0, seconds=3.0)))


def test_table_has_a_row_for_each_candidate(measured):
    """Losses by scenario, their mean, the worst, and the mean against the bound."""
    (table,) = measured("quality")
    assert [row[0] for row in table.rows] == [candidate.name for candidate in candidates()]
    assert table.columns[1:4] == ("few important", "mixed", "most important")
    for row in table.rows:
        *each, mean, worst, _ = map(float, row[1:])
        assert min(each) - 0.01 <= mean <= max(each) + 0.01 <= worst + 0.02
    assert "proven for 3 of 3" in table.note
