"""Parts of a limit out of bids: never more than all of it, most to what is worth most, something for everyone."""

from itertools import permutations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.protocol.bid import UNIT, Segment, density_of
from proxy.core.split.allocation import allocate, worth_of_equal

segments = st.builds(Segment, st.integers(1, UNIT), st.integers(0, 255), st.sampled_from([0, 0, 1, 2, 4]))
bids = st.lists(segments, max_size=8).map(tuple)
tables = st.dictionaries(st.sampled_from("abcdefghijkl"), st.none() | bids, min_size=1)


@given(tables, st.integers(0, 500))
def test_parts_and_slots_never_exceed_the_limit_less_the_floor(table, floor):
    """Whatever robots ask for, all parts and slots together leave the floor; and little is left over."""
    allocation = allocate(table, len(table), floor)
    assert allocation.total <= UNIT - floor
    assert allocation.total >= UNIT - floor - 2 * len(table)
    assert all(part >= 0 for part in allocation.parts.values())
    assert set(allocation.parts) == set(table)


@pytest.mark.parametrize(("amounts", "alike"), [((900, 900, 900), 3.0), ((2400, 0, 0), 1.0), ((1600, 800), 1.8)])
def test_unequal_parts_vary_as_fewer_equal_ones(amounts, alike):
    """One that is large beside the others varies nearly as a single robot does."""
    table = {f"r{number}": (Segment(amount, 100),) for number, amount in enumerate(amounts) if amount}
    allocation = allocate(table, len(amounts), UNIT - sum(amounts))
    assert allocation.alike == pytest.approx(alike, rel=0.01)


@given(tables)
def test_the_order_in_which_bids_were_heard_changes_nothing(table):
    """All who have the same table compute the same parts."""
    turned = dict(reversed(table.items()))
    assert allocate(table, len(table), 100, 7) == allocate(turned, len(turned), 100, 7)


@given(tables)
def test_who_asks_for_small_messages_has_some_room(table):
    """Nobody is silent, however much more the others' messages are worth."""
    parts = allocate(table, len(table), 200).parts
    equal = (UNIT - 200) // len(table)
    for tag, bid in table.items():
        asked = sum(segment.amount for segment in bid or () if not segment.quarters)
        assert parts[tag] >= min(asked, equal // 8)


@given(bids, st.integers(2, 12), st.integers(0, 200))
def test_equal_bids_get_equal_parts(bid, robots, floor):
    """All have as much as one another, in parts and in turns, where each can have a piece of every message."""
    allocation = allocate({f"r{i:02}": bid for i in range(robots)}, robots, floor)
    if not any(segment.quarters for segment in bid):
        assert max(allocation.parts.values()) - min(allocation.parts.values()) <= 1 + len(bid)


@pytest.mark.parametrize(("robots", "size", "slots"), [(10, 2000, 5), (4, 4160, 2), (8, 4160, 1), (3, 9000, 1)])
def test_messages_larger_than_an_equal_part_go_by_turns(robots, size, slots):
    """Robots that want the same share what slots there is room for, each for as long as the others."""
    small = () if size * slots == UNIT else (Segment(300, 200),)
    bid = (*small, Segment(size, 120, 1), Segment(size, 110, 1), Segment(size, 100, 2))
    floor = 0 if size * slots == UNIT else 100
    allocation = allocate({f"r{i:02}": bid for i in range(robots)}, robots, floor)
    assert [slot.size for slot in allocation.slots] == [size] * slots
    assert sorted(tag for slot in allocation.slots for tag, _ in slot.ring) == [f"r{i:02}" for i in range(robots)]
    assert {share for slot in allocation.slots for _, share in slot.ring} == {1}


def test_what_is_worth_most_is_served_first():
    """One robot's large messages are worth more than another's: it has a slot of its own, and the rest is shared."""
    high = (Segment(4000, 150, 4),)
    low = (Segment(4000, 120, 4),)
    allocation = allocate({"a": low, "b": high, "c": low}, 3, 100)
    assert allocation.parts["b"] >= 4000
    assert [(slot.size, {tag for tag, _ in slot.ring}) for slot in allocation.slots] in ([(4000, {"a", "c"})], [])


def test_a_robot_whose_bid_is_unknown_has_an_equal_part():
    """It may ask for anything, so it has what it would have if all asked for the same."""
    allocation = allocate({"a": (Segment(9000, 200),), "b": None}, 2, 200)
    assert allocation.parts == {"a": 4900, "b": 4900}


def test_what_nobody_asks_for_is_shared_evenly():
    """Robots that ask for little have as much again to spare."""
    allocation = allocate({"a": (Segment(100, 10),), "b": ()}, 2, 200)
    assert allocation.parts == {"a": 4950, "b": 4850}


def test_a_longer_turn_is_at_most_four_times_a_shorter_one():
    """So that the others do not wait for long, however much more one robot's messages are worth."""
    high = tuple(Segment(9000, 150, quarters) for quarters in (1, 2))
    low = (Segment(9000, 100, 1),)
    (slot,) = allocate({"a": high, "b": low}, 2, 100).slots
    assert dict(slot.ring) == {"a": 3, "b": 1}


def test_a_message_larger_than_the_limit_has_all_that_is_left_in_its_turn():
    """Beside what is worth more, and by turns with whoever wants a slot, too."""
    small, huge = Segment(200, 200), Segment(UNIT, 100, 1)
    allocation = allocate({"a": (small, huge), "b": (small, Segment(4000, 99, 1)), "c": (small,)}, 3, 100)
    assert allocation.parts == {"a": 5500, "b": 4200, "c": 200}
    allocation = allocate({"a": (small, huge), "b": (small, huge)}, 2, 100)
    assert [(slot.size, len(slot.ring)) for slot in allocation.slots] == [(9500, 2)]


def test_who_gains_most_by_a_message_has_the_first_turn():
    """Whatever the seed says; among those who gain about the same it decides."""
    table = {"a": (Segment(6000, 100, 1),), "b": (Segment(6000, 101, 1),), "c": (Segment(6000, 140, 1),)}
    firsts = {allocate(table, 3, 100, seed).slots[0].ring[:2] for seed in range(6)}
    assert {ring[0][0] for ring in firsts} == {"c"}
    assert {ring[1][0] for ring in firsts} == {"a", "b"}


def test_a_part_or_slot_carries_a_message_that_fits():
    """Of messages larger than the limit half is a slot."""
    bids = {"a": (Segment(2000, 150, 4),), "b": (Segment(6000, 100, 2),), "c": (Segment(6000, 100, 2),)}
    allocation = allocate(bids, 3, 100)
    assert allocation.carries("a", 2000)
    assert not allocation.carries("a", 2634)
    assert allocation.carries("b", 6000)
    assert not allocation.carries("b", 8000)
    assert allocation.carries("b", UNIT)
    assert not allocation.carries("d", 6000)


def test_allocations_resemble_each_other_where_amounts_are_nearly_the_same():
    """And the same robots share the same slots."""

    def made(size=4000, small=300, who="ab"):
        return allocate({tag: (Segment(small, 150), Segment(size, 100, 2)) for tag in who}, len(who), 100)

    assert made().resembles(made(4200, 320))
    assert not made().resembles(made(5200))
    assert not made(7000).resembles(made(7000, 1500))
    assert not made().resembles(made(who="abc"))
    assert not made(9000, who="ab").resembles(made(9000, who="ac"))


LOW, HIGH = (Segment(6000, 100, 2),), (Segment(6000, 132, 2),)


def test_slots_are_worth_what_their_robots_gain_by_them():
    """Each has a slot for a part of the time; room that no message fits is worth nothing, nor is what is divisible."""
    allocation = allocate({"a": LOW, "b": LOW}, 2, 100)
    assert [dict(slot.ring) for slot in allocation.slots] == [{"a": 1, "b": 1}]
    unit = density_of(100)
    # Each has half of the slot, which is what it asks for, and what nobody does.
    assert allocation.worth({"a": LOW, "b": ()}) == pytest.approx(3000 * unit)
    assert allocation.worth({"a": LOW, "b": HIGH}) == pytest.approx(3000 * 17 * unit)
    assert allocation.worth({"a": (Segment(6000, 100, 4),)}) == pytest.approx((3000 + 1950) * unit)
    assert allocation.worth({"a": (Segment(9000, 100, 4),), "c": HIGH}) == 0.0
    assert allocation.worth({"a": (Segment(400, 120),)}) == 0.0


def test_the_order_of_bids_changes_no_bit_of_what_slots_are_worth():
    """Members are a set of names, whose order differs between processes: one would give up its slots, another not."""
    bids = {
        tag: (Segment(1500 + 37 * i, 100 + i, 1), Segment(1500 + 37 * i, 96 - i, 1)) for i, tag in enumerate("abcde")
    }
    allocation, orders = allocate(bids, 5, 100), [dict(order) for order in permutations(bids.items())]
    assert len({allocation.worth(order) for order in orders}) == 1
    assert len({worth_of_equal(order) for order in orders}) == 1


def test_where_the_last_message_is_worth_as_much_as_the_first_there_are_no_turns():
    """As many robots have slots of their own as there is room for, whatever the others would do with turns."""
    bid = (Segment(1900, 80, 1), Segment(1900, 80, 1), Segment(1900, 80, 2))
    allocation = allocate({f"r{i}": bid for i in range(8)}, 8, 100)
    assert not allocation.slots
    assert sorted(part // 1900 for part in allocation.parts.values()) == [0, 0, 0, 1, 1, 1, 1, 1]


def test_each_has_a_slot_before_any_has_two_that_are_worth_as_much():
    """Who is first by name took three, and the last one of four had next to nothing."""
    bid = (Segment(1900, 80, 1), Segment(1900, 80, 1), Segment(1900, 80, 2), Segment(1900, 80, 4))
    allocation = allocate({f"r{i}": bid for i in range(4)}, 4, 100)
    assert not allocation.slots
    assert sorted(part // 1900 for part in allocation.parts.values()) == [1, 1, 1, 2]
