"""What is gained, piece by piece."""

import numpy as np
import pytest

from planner import Aggregation, Message, Problem, Stream
from planner.definition import utility
from studies.replay.pieces import LENGTH, MOST, Gains, borders_of, falls, undominated
from tests.studies.replay.traffic import entered, mission, samples, spec


@pytest.mark.parametrize("aggregation", [each.value for each in Aggregation])
def test_all_pieces_together_are_worth_what_the_definition_says(aggregation):
    """Whatever falls into which piece."""
    outcomes = entered(mission(spec(aggregation)), samples(), lambda number: number % 3 != 1)
    columns = outcomes.columns()
    gained = Gains(outcomes, columns, np.array([0.0, 3.3, 3.4, 11.0, 21.0])).of(columns.t_rcv)
    every = tuple(
        Message(0, t, t, t if np.isnan(r) else r, outcomes.utility(0), s, (), sent=not np.isnan(r))
        for t, r, s in zip(columns.t, columns.t_rcv, columns.scale, strict=True)
    )
    whole = Problem((Stream(0, Aggregation(aggregation)),), every, 0, (), (), t_start=0.0, t_end=21.0)
    tolerance = 1e-3 if aggregation == "best" else 1e-9  # best is integrated step by step
    assert gained.shape == (4, 1)
    assert gained.sum() == pytest.approx(utility(whole, ()), rel=tolerance)


def test_pieces_are_shorter_where_there_is_much():
    """A piece is to be bounded in one go."""
    edges = borders_of(np.sort(np.random.default_rng(0).uniform(0, 100, 3 * MOST)), 250.0)
    assert edges[0] == 0.0
    assert edges[-1] == 250.0
    assert {LENGTH, 2 * LENGTH} <= set(edges)
    assert len(edges) > 4
    assert borders_of(np.array([0.0]), 101.0).tolist() == [0.0, 101.0]  # a rest is no piece of its own
    crowd = np.zeros(2 * MOST)
    assert np.diff(borders_of(crowd, 50.0)).min() < 1e-3  # and ends where no time is left to cut


def test_what_is_newer_and_worth_as_much_makes_others_superfluous():
    """Unless a utility grows with age."""
    text = spec() + '[[information_type]]\nname = "t"\nkeys = ["*/t"]\nutility = { kind = "table", points = [[0, 0.0],'
    outcomes = entered(mission(text + "[1, 1.0], [2, 0.0]] }\n"), [*samples(5), *samples(5, key="r1/t")])
    columns = outcomes.columns()
    kept = undominated(outcomes, columns, np.arange(10))
    assert columns.scale[kept].tolist() == sorted(columns.scale[kept], reverse=True)
    assert kept[-1] == 9
    assert len(kept) < 10
    assert falls(outcomes, 0)
    assert not falls(outcomes, 1)
    assert undominated(outcomes, columns, np.arange(10, 20)).tolist() == list(range(10, 20))
