"""What is not taken in is counted, and a flood of it is said loudly."""

import logging

import pytest

from proxy.bridge.bounds import BOUNDS
from proxy.bridge.floods import Floods


@pytest.fixture
def told():
    return []


@pytest.fixture
def floods(told):
    return Floods(told.append)


def test_single_messages_are_told_one_by_one(floods, told):
    """They are no flood."""
    for second in range(20):
        floods.refuse(float(second), "r1", "digest:malformed")
    assert [(event.robot, event.kind, event.count) for event in told] == [("r1", "digest:malformed", 1)] * 20
    assert (floods.describe(20.0), floods.warnings(20.0)) == ({}, [])


def test_a_flood_is_told_in_few_events_that_count_all_of_it(floods, told, caplog):
    """And in the log in a line a minute for each kind."""
    with caplog.at_level(logging.WARNING):
        for step in range(130_000):
            floods.refuse(step / 1000, "evil", "digest:old")
            if step % 2 == 0:
                floods.refuse(step / 1000, "evil", "state:flood")
    floods.flush(130.0)
    for kind, count in (("digest:old", 130_000), ("state:flood", 65_000)):
        events = [event.count for event in told if event.kind == kind]
        assert sum(events) == count
        assert len(events) <= BOUNDS.flood_at_once + BOUNDS.flood * 130.0 + 1
        lines = [record.getMessage() for record in caplog.records if kind in record.getMessage()]
        assert len(lines) == 1 + 130.0 // BOUNDS.warnings_apart
    described = floods.describe(131.0)
    assert described["digest:old"]["messages"] == pytest.approx(130_000, rel=0.02)
    assert described["digest:old"]["age"] == pytest.approx(1.0, abs=0.01)
    assert [text.split(": ")[1].split(" ", 1)[1] for text in floods.warnings(131.0)] == [
        "messages too many so far (digest:old)",
        "messages too many so far (state:flood)",
    ]
    assert floods.warnings(130.0 + BOUNDS.warnings_apart) == []
