"""`best`: columns that tell how far down a ranking nothing is sent."""

import random
from dataclasses import replace

import numpy as np
import pytest

from planner import Aggregation, Linear, Receiver
from planner.definition import utility
from studies.oracle.aggregations.best import build, no_ranks
from studies.oracle.aggregations.rankings import rank
from tests.seeds import seeds
from tests.studies.oracle.problems import of_kind, one_stream, received


def drawn(seed):
    """Six messages that fade and weigh differently, for two receivers; perhaps one is known to be sent."""
    draw = random.Random(seed)
    times = sorted(draw.uniform(0.0, 3.0) for _ in range(6))
    problem = of_kind(one_stream(times, window=0.5, limit=1.0), Aggregation.BEST, Receiver(), Receiver(0.4, 2.0))
    messages = tuple(
        m._replace(utility=Linear(draw.uniform(0.2, 2.0), draw.uniform(0.01, 1.5)), sent=at == seed % 12)
        for at, m in enumerate(problem.messages)
    )
    return replace(problem, messages=messages, current=1 if messages[0].sent else 0)


@pytest.mark.parametrize("seed", seeds(24))
def test_ranks_reached_are_worth_the_utility(seed):
    """Of any plan, the columns of the ranks it reaches add up to U by the definition."""
    problem = drawn(seed)
    order = received(problem)
    ranks = build(order, [rank(order, 0)])
    draw = random.Random(seed)
    for _ in range(4):
        sends = [at for at in range(6) if draw.random() < 0.4 and not problem.messages[at].sent]
        sent = np.array([m.sent or at in sends for at, m in enumerate(problem.messages)], dtype=np.float64)
        assert ranks.gain @ ranks.values(sent) == pytest.approx(utility(problem, sends), rel=1e-5, abs=1e-9)


@pytest.mark.parametrize("seed", seeds(12))
def test_rows_allow_just_the_ranks_reached(seed):
    """The values are within their rows, and none can be greater."""
    order = received(drawn(seed))
    ranks = build(order, [rank(order, 0)])
    draw = random.Random(seed)
    x = np.array([draw.random() * 0.6 for _ in range(6)])
    x = np.concatenate((x, ranks.values(x)))
    entries = ranks.rows(6)
    used = np.zeros(len(ranks.rank))
    np.add.at(used, entries.row, entries.value * x[entries.column])
    assert used.max() <= 1e-12
    assert np.all((used > -1e-12) | (x[6:] == 1.0))


def test_problems_of_other_kinds_have_no_ranks():
    """No stream of `best`, no columns, no rows."""
    assert len(no_ranks().rows(5).row) == 0
    assert len(no_ranks().values(np.ones(5))) == 0
