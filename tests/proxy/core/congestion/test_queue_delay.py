"""Waiting is what a one-way time exceeds its least recent value by, whatever the clocks show."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.congestion.queue_delay import OneWayDelays, standing_queue
from proxy.core.congestion.tuning import TUNING


def way(waits, *, clock=0.0, every=0.2, start=0.0):
    """A way on which what was sent each so often waited so long; the sender's clock is off by `clock`."""
    made = OneWayDelays()
    waits = [
        max(wait, *(w - (i - k) * every for k, w in enumerate(waits[:i]))) if i else wait
        for i, wait in enumerate(waits)
    ]
    for i, wait in enumerate(waits):
        sent = start + i * every
        assert made.note(sent + 0.01 + wait, sent + clock, sent + 0.01 + wait)
    return made


@given(st.floats(-1e6, 1e6), st.lists(st.floats(0.0, 2.0), min_size=3, max_size=30))
def test_no_clock_matters(clock, waits):
    """The delay is the same whatever the sender's clock shows, never negative and never more than all waited."""
    now = 0.2 * len(waits) + 2.5
    ours, theirs = (standing_queue(now, [way(waits, clock=c)], 0.0, 0.05) for c in (0.0, clock))
    assert (ours is None) == (theirs is None)
    if ours is None or theirs is None:
        return
    assert ours.delay == pytest.approx(theirs.delay, abs=1e-6)
    assert 0.0 <= ours.delay <= max(waits) + 1e-9
    assert 0.0 < ours.share <= 1.0


def test_a_queue_that_is_empty_now_and_then_does_not_stand():
    """A burst waits behind itself; the next message finds the way free."""
    found = standing_queue(2.72, [way([0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 0.3], every=0.4)], 0.0, 0.05)
    assert found is not None
    assert found.delay == pytest.approx(0.0)


def test_a_growing_queue_tells_what_comes_through():
    """Of what is sent at twice the rate of the channel, half comes through."""
    found = standing_queue(1.9, [way([0.0, 0.0, 0.2, 0.4, 0.6])], 0.0, 0.1)
    assert found is not None
    assert found.delay == pytest.approx(0.4)
    assert found.share == pytest.approx(0.5)


def test_a_queue_drains_though_nobody_tells():
    """What is left of it falls with the time since its newest digest, as little is sent meanwhile."""
    found = standing_queue(2.0, [way([0.0, 0.0, 0.6, 0.6, 0.6])], 0.0, 0.1)
    assert found is not None
    assert found.seen_at == pytest.approx(0.8 + 0.01 + 0.6)
    assert found.left(found.seen_at) == found.delay == pytest.approx(0.6)
    assert found.left(found.seen_at + 0.5) == pytest.approx(0.6 - 0.5 * (1.0 - TUNING.least_while_draining))
    assert found.left(found.seen_at + 2.0) < 0.0


def test_one_robot_far_away_is_no_full_channel():
    """Where there are several ways what stands must stand on two of them."""
    far, near = way([0.0, 0.5, 0.5, 0.5]), way([0.0, 0.0, 0.0, 0.0])
    alone, both = standing_queue(1.3, [far], 0.0, 0.05), standing_queue(1.3, [far, near], 0.0, 0.05)
    assert alone is not None
    assert alone.delay == pytest.approx(0.5)
    assert both is not None
    assert both.delay == pytest.approx(0.0)


@pytest.mark.parametrize("since", [0.85, 5.0])
def test_too_little_tells_nothing(since):
    """One message since then, or none: a queue may be there or not."""
    assert standing_queue(1.0, [way([0.0, 0.0, 0.0, 0.0, 0.0])], since, 0.05) is None
    assert standing_queue(1.0, [OneWayDelays()], since, 0.05) is None


def test_a_longer_way_is_taken_for_what_it_is_after_a_while():
    """And what is told twice is no news."""
    made = way([0.0] * 5 + [0.3] * 95)
    found = standing_queue(20.2, [made], 0.0, 0.05)
    assert found is not None
    assert found.delay == pytest.approx(0.0)
    assert not made.note(21.0, 99 * 0.2, 21.0)
