"""`sum`: a column for each message."""

from planner import Aggregation, Receiver
from studies.oracle import optimum
from studies.oracle.aggregations.independent import build
from tests.studies.oracle.problems import of_kind, one_stream, received


def test_each_message_is_worth_all_it_has():
    """No rows are needed, and each receiver adds what its share is worth."""
    part = build(received(of_kind(one_stream([0.0, 4.0], window=1.0, limit=1.0), Aggregation.SUM)))
    assert part.gain.tolist() == [5.0 - 25 / 16, 1.0 - 1 / 16]
    assert len(part.supply) == 0
    two = Receiver(), Receiver(0.0, 2.0)
    more = build(received(of_kind(one_stream([0.0, 4.0], window=1.0, limit=1.0), Aggregation.SUM, *two)))
    assert more.gain.tolist() == (3 * part.gain).tolist()


def test_only_the_channel_keeps_messages_from_being_sent():
    """What was sent before takes nothing from the next message: the two worth most are sent."""
    problem = of_kind(one_stream([0.0, 0.25, 0.5, 2.0], window=1.0, limit=1.0), Aggregation.SUM)
    assert optimum(problem).sends.tolist() == [1.0, 0.0, 0.0, 1.0]
