"""Whose turn it is with a slot."""

from proxy.core.split.allocation import Slot
from proxy.core.split.tuning import TUNING
from proxy.core.split.turns import Turn

RING = Slot(4000, (("a", 1), ("b", 2), ("c", 1)))


def test_numbers_only_grow():
    """A late digest does not give a slot back."""
    turn = Turn(RING)
    assert turn.holder == "a"
    assert turn.heard(5.0, "a", 1, 0.0)
    assert turn.heard(6.0, "b", 2, 0.0)
    assert not turn.heard(7.0, "a", 1, 0.0)
    assert turn.holder == "c"


def test_only_who_passed_a_slot_on_knows_how_long_it_has_been_unused():
    """From anybody else it counts as used until now."""
    turn = Turn(RING)
    turn.heard(5.0, "a", 1, 0.4)
    assert turn.used == 4.6
    turn.heard(6.0, "a", 2, 0.4)
    assert turn.used == 6.0


def test_a_turn_begins_when_the_window_is_empty_and_lasts_as_long_as_its_share():
    """One window for a share of one."""
    turn = Turn(RING, used=5.0)
    assert turn.ends(0.5, 0.01) == 6.0
    turn.heard(6.0, "a", 1, 0.0)
    assert turn.ends(0.5, 0.01) == 7.5


def test_turns_are_longer_where_news_take_long():
    """But everyone's turn comes in time."""
    turn = Turn(RING, used=0.0)
    assert turn.ends(0.5, 0.2) == 0.5 + 3.0
    long = turn.ends(0.5, 3.0) - 0.5
    assert 0.5 < long <= TUNING.round_time / 4
    assert turn.ends(0.5, 100.0) == 1.0
