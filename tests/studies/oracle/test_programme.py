"""The matrices of the programme."""

import numpy as np

from planner.definition import utility
from studies.oracle.programme import build_programme
from tests.studies.oracle.problems import one_stream


def test_greatest_gain_is_the_unit():
    """Costs lie between −1 and 0 whatever the weights, and turn back into utility."""
    programme = build_programme(one_stream([0.0, 1.0, 2.0], window=0.5, limit=1.0))
    assert programme.cost.min() == -1.0
    assert programme.cost.max() == 0.0
    assert programme.utility(-1.0) == programme.unit


def test_a_plan_is_a_path_that_costs_its_utility():
    """Sending the first and the last of three messages balances every node and costs its utility."""
    problem = one_stream([0.0, 1.0, 2.0], window=0.5, limit=1.0)
    programme = build_programme(problem)
    x = np.zeros(len(programme.cost))
    x[: programme.messages] = [1.0, 0.0, 1.0]
    for column in range(programme.messages, len(x)):
        rows = programme.balance[:, [column]].toarray()[:, 0]
        head, tail = int(np.argmax(rows)), int(np.argmin(rows))
        # Nodes 0 to 2 are the messages and 3 to 6 the empty ones; rows 7 to 9 count what leaves the messages.
        if (tail, head) in {(3, 0), (7, 2), (9, 6)}:
            x[column] = 1.0
    assert np.array_equal(programme.balance @ x, programme.supply)
    assert programme.utility(float(programme.cost @ x)) == utility(problem, [0, 2])
