"""What missions and flights are worth."""

from dataclasses import replace

import pytest

from studies.bench.format import read
from studies.bench.worth import bounded, reached
from studies.simulation.records import Delivery, Frame
from tests.studies.bench.small import HEAD, STREAM, write


@pytest.fixture
def one(tmp_path):
    """A mission of two samples of one robot, of which one fits: u = 1 − a/2, from 2 s to 12 s."""
    given = [HEAD | {"limits": [{"kind": "messages", "limit": 1.0, "window": 5.0}]}, STREAM]
    return read(write(tmp_path / "one.jsonl", [*given, [3.0, 0, 100], [4.0, 0, 100]]))


def test_the_bound_is_what_can_be_gained_at_most(one):
    """At the latency: either sample counts from 0.05 s to 2 s of age; both would add what the first has before."""
    pytest.importorskip("scipy")
    head = bounded(one).head
    each = (1.95**2) / 4
    assert head.bound == pytest.approx(each, rel=1e-4)
    assert head.bound >= each
    first_until_second = 1.05 - (1.05**2 - 0.05**2) / 4 - 0.05
    assert head.all == pytest.approx(first_until_second + each, rel=1e-4)


def test_a_flight_gains_by_the_mean_of_who_wants_it(one):
    """Here the operator alone; of two robots each wants the other's, too."""
    frames = [Frame("r0", "r0/pose", m.t_gen, 100, {}) for m in one.problem.messages]
    numbers = {id(frame): i for i, frame in enumerate(frames)}
    deliveries = [Delivery(frames[0], 3.0, 3.05, "operator"), Delivery(frames[1], 4.0, None, "operator")]
    assert reached(one, numbers, deliveries) == pytest.approx((1.95**2) / 4)
    two = replace(one, streams=(*one.streams, one.streams[0].model_copy(update={"robot": "r1"})))
    assert reached(two, numbers, deliveries) == pytest.approx((1.95**2) / 8)


def test_the_warm_up_is_not_scored(one):
    """What was received in it counts from its end on."""
    late = replace(one, head=one.head.model_copy(update={"warm_up": 4.0}))
    frame = Frame("r0", "r0/pose", 3.0, 100, {})
    gained = reached(late, {id(frame): 0}, [Delivery(frame, 3.0, 3.05, "operator")])
    assert gained == pytest.approx(1 / 4)
