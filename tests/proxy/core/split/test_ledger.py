"""What we sent, and what of it counts against a part that has become smaller."""

import pytest

from proxy.core.split.own_part import Ledger


def test_what_was_sent_counts_for_as_long_as_a_window():
    """Each limit has its own window."""
    ledger = Ledger((1.0, 2.0))
    ledger.sent(5.0, (10.0, 3.0))
    assert [ledger.kept(t, 0) for t in (5.0, 5.9, 6.0)] == [10.0, 10.0, 0.0]
    assert [ledger.kept(t, 1) for t in (5.0, 6.9, 7.0)] == [3.0, 3.0, 0.0]


def test_a_large_message_is_struck_off_when_its_room_is_given_up():
    """The small ones beside it stay, and go on."""
    ledger = Ledger((1.0,))
    for t, use in ((5.0, 2.0), (5.1, 40.0), (5.2, 3.0)):
        ledger.sent(t, (use,))
    ledger.strike(5.3, 8.0, 42.0)
    assert (ledger.kept(5.3, 0), ledger.struck(5.3, 0), ledger.last_struck) == (5.0, 40.0, 5.1)
    assert ledger.next_expiry(5.3) == 6.1
    assert ledger.struck(6.1, 0) == 0.0


def test_no_more_is_struck_off_than_the_room_that_is_given_up():
    """Of what does not fit in it, a part."""
    ledger = Ledger((1.0,))
    ledger.sent(5.0, (40.0,))
    ledger.strike(5.1, 10.0, 30.0)
    assert (ledger.kept(5.1, 0), ledger.struck(5.1, 0)) == pytest.approx((10.0, 30.0))


def test_what_fits_beside_is_not_struck_off():
    """So the room that is given up counts as unused."""
    ledger = Ledger((1.0,))
    ledger.sent(5.0, (4.0,))
    ledger.strike(5.1, 10.0, 30.0)
    assert (ledger.kept(5.1, 0), ledger.last_struck) == (4.0, float("-inf"))
