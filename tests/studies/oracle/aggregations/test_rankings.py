"""Rankings of messages over time."""

from dataclasses import replace

import pytest

from planner import Aggregation, Linear, Receiver
from studies.oracle.aggregations.rankings import rank
from tests.studies.oracle.problems import of_kind, one_stream, received


def best(utilities, *receivers, sent=()):
    times = [float(at) for at in range(len(utilities))]
    problem = of_kind(one_stream(times, window=0.5, limit=1.0), Aggregation.BEST, *receivers)
    messages = tuple(
        m._replace(utility=utility, sent=at in sent)
        for at, (m, utility) in enumerate(zip(problem.messages, utilities, strict=True))
    )
    return received(replace(problem, messages=messages, current=next(i for i, m in enumerate(messages) if not m.sent)))


def test_messages_that_fade_alike_rank_by_age():
    """The newest is the best, so there is a ranking for each receipt, and the stream is like one of most_recent."""
    found = rank(best([Linear(1.0, 0.125)] * 3), 0)
    assert list(found.areas) == [(0,), (1, 0), (2, 1, 0)]
    assert found.newest_first


def test_ranks_change_where_utilities_cross():
    """A rich message that fades fast is overtaken by a poor one that lasts, at the moment they are worth the same."""
    found = rank(best([Linear(0.5, 0.001), Linear(2.0, 1.0), Linear(0.1, 0.1)]), 0)
    assert not found.newest_first
    assert list(found.areas) == [(0,), (1, 0), (1, 0, 2), (0, 1, 2)]
    lasts = found.areas[0, 1, 2][0]
    begin, end = 1.0 + (2.0 - (0.5 - 0.001)) / 0.999, 3.0
    assert lasts == pytest.approx(0.5 * (end - begin) - 0.0005 * (end**2 - begin**2), rel=1e-2)


def test_a_change_in_the_last_piece_is_found():
    """Ranks that change just before the next receipt are cut as finely as any."""
    found = rank(best([Linear(0.5, 0.001), Linear(1.48, 1.0), Linear(9.0, 0.1)]), 0)
    assert (0, 1) in found.areas
    assert found.areas[0, 1].sum() < 0.03


def test_the_dead_do_not_rank():
    """When a message is worth nothing any more an older one may be the best: the stream is not one of most_recent."""
    found = rank(best([Linear(1.0, 0.1), Linear(1.0, 2.0)]), 0)
    assert list(found.areas) == [(0,), (1, 0), (0, 1)]
    assert not found.newest_first


def test_nothing_ranks_behind_a_fact():
    """What is worth less than something that is sent anyway is worth nothing."""
    found = rank(best([Linear(1.0, 0.125)] * 3, sent=[1]), 0)
    assert list(found.areas) == [(0,), (1,), (2, 1)]


def test_receivers_share_their_rankings():
    """The same order at different times is one ranking; a receiver of no share has none."""
    one = rank(best([Linear(1.0, 0.125)] * 3), 0)
    two = rank(best([Linear(1.0, 0.125)] * 3, Receiver(), Receiver(0.0, 2.0), Receiver(0.5, 0.0)), 0)
    assert list(two.areas) == list(one.areas)
    assert two.areas[1, 0] == pytest.approx(3 * one.areas[1, 0])
