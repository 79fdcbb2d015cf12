"""Bids on the wire, and when two are alike."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.protocol.bid import UNIT, Segment, alike, alike_but_for_slots, level_of, packed, unpacked

segments = st.builds(Segment, st.integers(1, UNIT), st.integers(0, 255), st.sampled_from([0, 1, 2, 4]))


@given(st.lists(segments, max_size=8).map(tuple))
def test_a_bid_survives_the_wire(bid):
    """Three bytes a segment say all of it."""
    assert unpacked(packed(bid)) == bid
    assert len(packed(bid)) == 3 * len(bid)


@given(st.binary(max_size=30))
def test_what_is_no_bid_is_refused(data):
    """Any bytes are a bid that has these bytes, or none."""
    try:
        bid = unpacked(data)
    except ValueError:
        return
    assert packed(bid) == data


@pytest.mark.parametrize("wrong", [(0, 1, 0), (UNIT + 1, 1, 0), (1, 256, 0), (1, 1, 3)])
def test_what_is_no_segment_is_refused(wrong):
    """A segment asks for something, at most all, in quarters that a slot has."""
    with pytest.raises(ValueError, match="no segment"):
        Segment(*wrong)


def test_levels_grow_with_value_and_stay_in_a_byte():
    """Eight levels double the value; nothing is worth level 0."""
    assert level_of(2.0) - level_of(1.0) == 8
    assert (level_of(0.0), level_of(1e-300), level_of(1e300)) == (0, 0, 255)


def test_noise_makes_no_other_bid():
    """A step of a level, or a quarter of an amount, is about the same; twice as much is not."""
    bid = (Segment(100, 50), Segment(2000, 40, 1))
    assert alike(bid, (Segment(120, 51), Segment(1800, 39, 1)))
    assert not alike(bid, (Segment(200, 50), Segment(2000, 40, 1)))
    assert not alike(bid, (Segment(100, 52), Segment(2000, 40, 1)))
    assert not alike(bid, bid[:1])
    assert not alike(bid, (Segment(100, 50), Segment(2000, 40, 2)))


LOW, HIGH = (Segment(6000, 100, 4),), (Segment(6000, 116, 4),)


def test_bids_are_alike_but_for_slots_where_these_are_worth_about_as_much():
    """And all else is little, and as before."""
    few, many, parts = (Segment(300, 150),), (Segment(400, 150),), (Segment(600, 150),)
    assert alike_but_for_slots((*few, *LOW), (*few, Segment(6000, 103, 4)))
    assert not alike_but_for_slots((*few, *LOW), (*few, *HIGH))
    assert not alike_but_for_slots((*few, *LOW), (*many, *LOW))
    assert not alike_but_for_slots((*parts, *LOW), (*parts, *LOW))
    assert not alike_but_for_slots(few, (*few, *LOW))
    assert not alike_but_for_slots(few, few)
