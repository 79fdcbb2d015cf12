"""Tables: their names, and who has agreed on them."""

import random

import pytest

from proxy.core.protocol.bid import Segment
from proxy.core.split.table import Table

BID = (Segment(300, 120),)


def table(entries, members=2, kind=b""):
    return Table("a", entries, members=members, floor=100, kind=kind)


@pytest.mark.parametrize(
    "other",
    [
        {"a": (2, BID), "b": (1, BID)},
        {"a": (1, BID), "b": None},
        {"a": (1, BID)},
        {"a": (1, BID), "b": (1, ())},
        {"a": (1, BID), "c": (1, BID)},
    ],
)
def test_tables_that_differ_have_other_names(other):
    """In a version, a bid or a robot."""
    assert table({"a": (1, BID), "b": (1, BID)}).name != table(other).name


def test_other_limits_make_other_names():
    """Robots that do not share the same limits never agree."""
    one = {"a": (1, BID), "b": (1, BID)}
    assert len({table(one).name, table(one, kind=b"x").name, table(one, members=3).name}) == 3
    assert table(one).name == table(dict(reversed(one.items()))).name


def test_names_are_spread_over_four_bytes():
    """And none is that of no table."""
    rng = random.Random(1)
    names = {table({"a": (rng.randint(0, 2**30), BID)}).name for _ in range(500)}
    assert len(names) == 500
    assert 0 not in names


def test_a_table_is_agreed_on_once_all_whose_bids_it_holds_told_it():
    """One whose bid nobody knows cannot have it."""
    held = table({"a": (1, BID), "b": (1, BID), "c": None}, members=3)
    assert not held.agreed
    held.confirm({"b": (held.name, 0)})
    assert held.agreed
    assert not held.complete


def test_a_slot_counts_for_the_one_whose_turn_it_is():
    """Beside what is its own."""
    bid = (Segment(300, 150), Segment(8000, 120, 2))
    held = table({"a": (1, bid), "b": (1, bid)})
    (turn,) = held.turns
    own = held.allocation.parts["a"]
    totals = set()
    for _ in range(2):
        totals.add(held.total)
        turn.pass_on()
    assert totals == {own, own + 8000}
