"""Bids out of streams."""

import math
from dataclasses import replace
from statistics import fmean

import pytest

from proxy.core.protocol.tuning import TUNING
from proxy.core.split.allocation import allocate
from proxy.core.split.demand import Demand, bid_for

CAMERA = Demand((0.416,), 10.0, lambda rate: 1.0 + math.log(1.0 + 10.0 * rate))
ODOMETRY = Demand((0.0019,), 20.0, lambda rate: 1.0 - 0.5 / max(rate, 0.5))
TELEMETRY = Demand((0.0022,), 5.0, lambda rate: 1.0 - 0.25 / max(rate, 0.25))
LOG = Demand((0.0013, 0.0038, 0.0064), 2.0, lambda rate: 1.0 - 0.1 / max(rate, 0.1))
ALARMS = Demand((0.0012,), 0.125, lambda rate: 200.0 * rate)
MIXED = (CAMERA, ODOMETRY, TELEMETRY, LOG, ALARMS)


def test_small_streams_come_first_and_large_messages_whole():
    """What is worth most for its room comes first, and the first message of several windows before a second one."""
    bid = bid_for(MIXED, 0.5, 4)
    assert len(bid) <= TUNING.segments
    assert [segment.level for segment in bid] == sorted((s.level for s in bid), reverse=True)
    assert bid[0].quarters == 0
    assert {s.amount for s in bid if s.quarters} == {4160}
    assert [s.quarters for s in bid if s.quarters][:3] == [1, 1, 2]


def test_small_streams_get_what_they_need():
    """Room for what they send in a window, and something of what is left."""
    parts = allocate({f"r{i}": bid_for(MIXED, 0.5, 4) for i in range(4)}, 4, 100).parts
    need = sum(fmean(d.sizes) * d.rate * 0.5 for d in MIXED[1:]) + max(LOG.sizes)
    assert all(part >= need * 10_000 for part in parts.values())


def test_small_streams_ask_for_the_first_messages_of_a_window_at_a_higher_level_than_for_the_last():
    """So that equal robots get alike, though the messages of some are a little smaller."""
    demands = {
        f"r{i}": Demand(((0.029, 0.031)[i % 2],), 14.0, lambda rate: 1.0 - 0.3 / max(rate, 0.3)) for i in range(8)
    }
    bids = {name: bid_for([demand], 1.0, 8) for name, demand in demands.items()}
    assert {segment.quarters for bid in bids.values() for segment in bid} == {0}
    levels = [segment.level for segment in bids["r0"]]
    assert levels == sorted(set(levels), reverse=True)
    assert sum(segment.amount for segment in bids["r0"]) == pytest.approx(10_000 * 0.029 * 14.0, abs=len(levels))
    parts = allocate(bids, 8, 100).parts
    assert max(parts.values()) < 1.5 * min(parts.values())


def test_a_small_stream_that_asks_for_little_asks_for_all_of_it_alike():
    """So that all of its samples come before large messages, though the last are worth less."""
    (segment,) = bid_for([ODOMETRY], 0.5, 8)
    assert segment.amount == pytest.approx(10_000 * 0.0019 * 10.0, abs=1)
    assert len(bid_for([ODOMETRY], 0.5, 100)) == 4


def test_small_streams_ask_for_what_they_vary_by():
    """Three standard deviations of what all together send in a window, in one segment."""
    varying = [replace(demand, variance=0.25 * fmean(demand.sizes) ** 2) for demand in MIXED[1:]]
    bid = bid_for([CAMERA, *varying], 0.5, 4)
    (spare,) = set(bid) - set(bid_for(MIXED, 0.5, 4))
    expected = 3.0 * math.sqrt(sum(demand.variance for demand in varying))
    assert spare.amount == pytest.approx(10_000 * expected, abs=1)
    parts = allocate({f"r{i}": bid for i in range(4)}, 4, 100).parts
    need = sum(fmean(demand.sizes) * demand.rate * 0.5 for demand in varying)
    assert all(part >= 10_000 * (need + expected) for part in parts.values())


def test_four_robots_with_cameras_share_what_frames_there_is_room_for():
    """Two frames fit in a window: each is for two robots in turn."""
    allocation = allocate({f"r{i}": bid_for(MIXED, 0.5, 4) for i in range(4)}, 4, 100)
    assert [(slot.size, len(slot.ring)) for slot in allocation.slots] == [(4160, 2), (4160, 2)]


def test_where_each_message_is_worth_as_much_each_is_asked_for_by_itself():
    """Not two at once: who has room for one alone would send none."""
    linear = Demand((0.19,), 1.0, lambda rate: rate)
    bid = bid_for([linear], 2.5, 10)
    assert {segment.amount for segment in bid} == {1900}


def test_one_robot_is_offered_no_more_than_its_streams_send():
    """A slow stream asks for a part of a slot, not for messages that it does not have."""
    slow = Demand((0.3,), 0.4, lambda rate: rate)
    assert sum(s.quarters for s in bid_for([slow], 0.5, 4)) <= 1


def test_messages_that_vary_ask_for_little_first():
    """Small ones are worth more for their room; more room lets larger ones through, bit by bit."""
    varied = Demand([i / 100 for i in range(2, 65, 2)], 10.0, lambda rate: rate / (1.0 + rate))
    bid = bid_for([varied], 0.5, 4)
    assert sum(segment.amount for segment in bid) > 3000
    assert max(segment.amount for segment in bid) < 1500


@pytest.mark.parametrize("demand", [Demand((0.1,), 0.0, float), Demand((0.0,), 5.0, float), Demand((), 5.0, float)])
def test_what_is_never_sent_asks_for_nothing(demand):
    """No rate or no size, no segment."""
    assert bid_for([demand], 0.5, 4) == ()


def test_a_message_larger_than_the_limit_asks_for_all_of_it():
    """It goes alone, in its turn."""
    (first, *_) = bid_for([Demand((3.0,), 1.0, float)], 0.5, 4)
    assert first.amount == 10_000


def test_many_streams_make_few_segments():
    """Those worth about the same are put together."""
    demands = [Demand((0.001,), 1.0 + i, lambda rate, i=i: 2.0**i * rate) for i in range(20)]
    bid = bid_for(demands, 0.5, 4)
    assert len(bid) <= TUNING.segments
    room = sum(0.001 * d.rate * 0.5 for d in demands)
    assert sum(s.amount for s in bid) == pytest.approx(10_000 * room, abs=len(bid))


def test_of_a_rhythm_so_many_messages_fit_as_lie_before_the_first_that_is_out_of_the_window():
    """With a period of 1.2 s one in 2.5 s is every third; with one of 0.85 s that is more of them."""
    slow, fast = (
        bid_for([Demand((0.19,), 1.0 / period, lambda rate: rate, period=period)], 2.5, 10) for period in (1.2, 0.85)
    )
    unknown = bid_for([Demand((0.19,), 1.0 / 1.2, lambda rate: rate)], 2.5, 10)
    assert slow[0].level < fast[0].level <= unknown[0].level
