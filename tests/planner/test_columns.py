"""A problem as columns."""

import dataclasses

import numpy as np

from planner import Aggregation, Receiver, Stream, Traffic
from tests.planner.windows import window

GOOD = window(3, robots=2, horizon=5)


def test_columns_say_what_the_messages_say():
    """Number by number, in the order of the window."""
    columns = GOOD.columns
    for at, m in enumerate(GOOD.messages):
        row = (columns.stream[at], columns.sent[at], *columns.times[:, at], columns.scale[at], *columns.use[at])
        assert row == (m.stream, m.sent, m.t_gen, m.t_sent, m.t_rcv, m.scale, *m.use)
        assert columns.utilities[columns.utility[at]] is m.utility
    assert columns.opened.tolist() == [at for at, m in enumerate(GOOD.messages) if not m.sent]


def test_they_are_read_once():
    """A problem never changes; one that is made from another has its own."""
    assert GOOD.columns is GOOD.columns
    fewer = dataclasses.replace(GOOD, traffic=(Traffic(1.0, (2.0,)),))
    assert fewer.columns.traffic_sent.tolist() == [1.0]
    assert fewer.columns.traffic_use.tolist() == [[2.0]]
    assert fewer != GOOD


def test_streams_without_as_many_receivers_have_some_of_no_share():
    """Their delay is 0, too; a stream that nobody wants has no other ones."""
    streams = (Stream(0, receivers=(Receiver(0.0, 2.0), Receiver(0.3, 1.0))), Stream(1, receivers=()))
    columns = dataclasses.replace(GOOD, streams=streams).columns
    assert columns.delay.tolist() == [[0.0, 0.3], [0.0, 0.0]]
    assert columns.share.tolist() == [[2.0, 1.0], [0.0, 0.0]]
    assert np.shape(dataclasses.replace(GOOD, streams=()).columns.delay) == (0, 1)


def test_streams_of_one_aggregation_are_together():
    """In the order in which the first of each comes."""
    kinds = (Aggregation.SUM, Aggregation.BEST, Aggregation.SUM)
    streams = tuple(Stream(robot, kind) for robot, kind in enumerate(kinds))
    found = dataclasses.replace(GOOD, streams=streams).columns.kinds
    assert found == ((Aggregation.SUM, [0, 2]), (Aggregation.BEST, [1]))
