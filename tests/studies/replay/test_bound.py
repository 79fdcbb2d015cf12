"""The bound is above all that can be reached, wherever it is cut."""

import numpy as np
import pytest

from planner import Aggregation, Constraint
from planner.definition import utility
from planner.measures import Throughput
from studies.oracle import optimum
from studies.replay import bound as bound_module
from studies.replay.bound import _Pieces, bound, relaxed
from studies.replay.errors import ReplayError
from studies.replay.mission import Limit
from studies.replay.pieces import Gains
from tests.studies.replay.traffic import POSE, entered, mission, samples, spec

WHOLE, CUT = np.array([0.0, 21.0]), np.array([0.0, 4.9, 5.2, 12.0, 21.0])


def bounded(outcomes, borders):
    told = []
    found = bound(outcomes, outcomes.columns(), borders, lambda done, of: told.append((done, of)))
    assert told == [(i + 1, len(borders) - 1) for i in range(len(borders) - 1)]
    return found


@pytest.mark.parametrize("aggregation", [each.value for each in Aggregation])
def test_no_plan_is_worth_more(aggregation):
    """The best one there is, by the integer programme; and cut into pieces the bound is no lower."""
    outcomes = entered(mission(spec(aggregation)), samples())
    whole, cut = bounded(outcomes, WHOLE), bounded(outcomes, CUT)
    columns = outcomes.columns()
    (piece,) = _Pieces(outcomes, columns, WHOLE).all()
    problem = piece.problem(piece.messages)
    best = optimum(problem)
    assert utility(problem, np.flatnonzero(best.sends).tolist()) <= whole.utility * (1 + 1e-6)
    assert whole.utility <= cut.utility * (1 + 1e-4)
    assert cut.by_type == {"camera": pytest.approx(cut.utility)}
    everything = Gains(outcomes, columns, CUT).of(columns.t + 0.01).sum()
    if aggregation != "most_recent":
        assert cut.utility <= everything * len(CUT)


def test_a_type_has_what_it_could_gain_alone():
    """So all types together have no less than the bound of all."""
    told = sorted([*samples(), *samples(key="r1/pose", period=0.2, size=300)], key=lambda each: each.t)
    found = bounded(entered(mission(spec() + POSE), told), CUT)
    assert set(found.by_type) == {"camera", "pose"}
    assert max(found.by_type.values()) <= found.utility <= sum(found.by_type.values()) * (1 + 1e-6)


def test_of_many_that_may_have_come_before_the_best_are_looked_at(monkeypatch):
    """What the others could be worth is added, so that it stays a bound."""
    outcomes = entered(mission(), samples())
    known = bounded(outcomes, CUT)
    monkeypatch.setattr(bound_module, "MOST_CARRIED", 1)
    assert bounded(outcomes, CUT).utility >= known.utility * (1 - 1e-6)


def test_what_nobody_decides_on_is_there_in_any_case():
    """It takes nothing of the limits in the bound, which is the higher for it."""
    outcomes = entered(mission(spec() + POSE + "bypass = true\n"), samples(key="r1/pose"))
    columns = outcomes.columns()
    assert bounded(outcomes, CUT).utility >= Gains(outcomes, columns, CUT).of(columns.t_rcv).sum() * (1 - 1e-9)


def test_age_at_publication_counts():
    """A sample that was old when it came is worth less."""
    young = samples()
    aged = [type(each)(each.robot, each.key, each.t, each.t - 1.0, each.size, each.features) for each in young]
    assert bounded(entered(mission(), aged), CUT).utility < bounded(entered(mission(), young), CUT).utility


def test_windows_are_shorter_by_what_samples_wait():
    """And several are looked at as one where they wait long."""
    limit = Limit("throughput", Throughput(100.0, 1.0))
    assert relaxed(limit, 0.1, 50.0) == Constraint("throughput", 0.9, 100.0)
    assert relaxed(limit, 1.0, 50.0) == Constraint("throughput", 4.0, 500.0)
    assert relaxed(limit, 1.0, 250.0) == Constraint("throughput", 4.0, 650.0)


def test_an_aggregation_of_ones_own_has_no_bound():
    """Nobody knows whether it can be cut."""
    own = spec().replace('"most_recent"', '{ python = "tests.utility_specs.models:Greatest" }')
    outcomes = entered(mission(own), samples())
    with pytest.raises(ReplayError, match='"camera" has an aggregation of its own'):
        bounded(outcomes, CUT)
    columns = outcomes.columns()
    assert Gains(outcomes, columns, CUT).of(columns.t_rcv).sum() > 0.0
