"""Adaptive limits grow while nothing stands in the way, and decrease for silence, queues and loss."""

import math

import pytest

from proxy.core.protocol.messages import Digest
from tests.proxy.core.congestion.channels import BEGIN, RATE, Channel


def test_a_free_channel_that_is_used_is_used_more_until_the_ceiling():
    """From between it and the floor, in seconds; fixed limits have no part in it."""
    channel = Channel()
    assert channel.factor == BEGIN
    assert channel.run(20.0).factor == 1.0
    assert channel.why == "free"
    assert channel.capacity.report(channel.now) == (1.0,)


def test_what_is_not_used_does_not_grow():
    """Nobody knows whether the channel bore more."""
    channel = Channel()
    channel.use = 0.3
    assert channel.run(20.0).factor == BEGIN
    assert channel.why == "not used"


def test_a_growing_queue_decreases_the_limit_at_once_and_not_again_while_it_drains():
    """And the others hear of it at once."""
    channel = Channel().run(20.0)
    channel.capacity.reported(Digest("us", "us", channel.now, 0, 0, capacity=(1.0,)))
    assert not channel.capacity.has_news(channel.now)
    for wait in (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35):
        channel.waits["op"] = wait
        channel.run(0.1)
    assert channel.why in ("delay", "settling")
    assert 0.2 <= channel.factor <= 0.7
    assert channel.capacity.has_news(channel.now)
    assert math.isfinite(channel.capacity.wakes_at(channel.now))
    low = channel.run(0.3).factor
    channel.waits["op"] = 0.0
    assert channel.run(1.0).factor > low


def test_a_queue_that_grows_on_and_on_is_reason_to_decrease_again():
    """What was sent since the last decrease need not come through to know that it was not enough."""
    channel = Channel().run(20.0)
    first, wait = None, 0.0
    for tenth in range(40):
        wait += 0.09
        channel.waits["op"] = wait
        channel.run(0.1)
        if first is None and channel.factor < 1.0:
            first = channel.capacity.described(channel.now, 0)["estimate"]
        if tenth == 10:
            early = channel.capacity.described(channel.now, 0)["estimate"]
    assert first > early > channel.capacity.described(channel.now, 0)["estimate"]


@pytest.mark.parametrize("silent", ["they", "we"])
def test_silence_is_no_good_news(silent):
    """Nothing arrives from anybody, or nobody says that ours arrives: down to the floor, and fast up again after."""
    channel = Channel().run(20.0)
    if silent == "they":
        channel.waits["op"] = None
    else:
        channel.hears_us = False
    assert channel.run(3.0).factor >= 0.7
    assert channel.run(20.0).factor == pytest.approx(0.05)
    assert channel.why == "silence"
    channel.waits["op"], channel.hears_us = 0.0, True
    assert channel.run(10.0).factor > 0.5


def test_what_is_overdue_is_waited_for():
    """It may stand in a queue: little is sent until it comes."""
    channel = Channel().run(20.0)
    channel.waits["op"] = None
    assert channel.run(1.0).factor <= 0.4
    assert channel.why == "overdue"
    channel.waits["op"] = 0.0
    assert channel.run(2.0).factor == 1.0


def test_a_queue_that_is_seen_decreases_the_limit_though_all_that_comes_is_old():
    """What is left for something overdue may be just what the channel bears, and the queue would stand for ever."""
    channel = Channel().run(20.0)
    channel.waits["op"] = None
    assert channel.run(1.0).why == "overdue"
    channel.waits["op"] = 1.5
    channel.run(1.0)
    assert channel.why in {"delay", "draining", "settling"}
    assert channel.capacity.report(channel.now) < (0.6,)


def test_one_robot_that_is_far_away_decreases_nothing():
    """Neither what we see of it, nor what it tells, nor its leaving."""
    channel = Channel(peers=("a", "b", "far"), receivers=("a", "b", "far")).run(20.0)
    channel.waits["far"] = 0.8
    channel.tells["far"] = 0.05
    assert channel.run(10.0).factor == 1.0
    channel.waits["far"] = None
    assert channel.run(10.0).factor == 1.0
    channel.capacity.forget("far")
    assert channel.run(10.0).factor == 1.0


def test_our_own_links_tell_as_well():
    """Of robots that we know."""
    channel = Channel().run(20.0)
    for i in range(8):
        channel.capacity.evidence.link_gauged(channel.now + 0.05, "op", 0.05 * i)
        channel.capacity.evidence.link_gauged(channel.now + 0.05, "stranger", 9.0)
        channel.run(0.1)
    assert channel.factor < 0.8


def test_random_loss_is_no_full_channel():
    """A constant loss does nothing. One that begins is tried out, and what was decreased for it is given back."""
    channel = Channel()
    channel.arriving = 0.95
    assert channel.run(30.0).factor == 1.0
    before = channel.sent
    channel.arriving = 0.95 * before / channel.sent
    received = 0.95 * before
    lowest = 1.0
    for _ in range(200):
        channel.run(0.1)
        received += 0.4 * (channel.sent - before)
        before, channel.arriving = channel.sent, received / channel.sent
        lowest = min(lowest, channel.factor)
    assert 0.3 < lowest < 0.8
    assert channel.run(10.0).factor > 0.95


def test_loss_by_load_decreases():
    """A channel that drops what it cannot carry, without any queue: less is sent, and less is lost."""
    channel = Channel()
    received = before = 0.0
    factors = []
    for i in range(600):
        channel.run(0.1)
        carried = min(channel.sent - before, 0.1 * RATE * (1.0 if i < 300 else 0.4))
        received, before = received + carried, channel.sent
        channel.arriving = received / channel.sent
        factors.append(channel.factor)
    assert factors[299] == 1.0
    assert max(factors[400:]) < 0.85


def test_a_leader_that_says_nothing_is_bad_news_like_anybody():
    """It may be that nothing gets through."""
    channel = Channel().run(20.0)
    channel.leader = "op"
    channel.run(1.0).waits["op"] = None
    assert channel.run(30.0).factor < 0.5
    assert channel.why == "silence"
