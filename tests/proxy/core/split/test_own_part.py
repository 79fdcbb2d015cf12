"""Our part of every limit as time passes, and what our sends use of it."""

import pytest

from proxy.core.protocol.bid import UNIT
from proxy.core.split.own_part import OwnPart
from proxy.core.split.split import Split
from tests.proxy.core.split.flight import FLOOR, WINDOW


def test_each_limit_has_its_own_window():
    """A message counts as what it uses of each."""
    split = Split("a", 0.0, (1.0, 2.0), floor=FLOOR, settled_at=0.0)
    split.advance(0.0, 0.0)
    split.sent(3.0, (0.5, 0.25))
    assert [split.own_part.free(3.0, limit) for limit in (0, 1)] == pytest.approx([0.48, 0.73])
    assert [split.own_part.free(4.0, limit) for limit in (0, 1)] == pytest.approx([0.98, 0.73])


def test_room_that_comes_is_used_a_window_later_and_what_goes_is_given_up_at_once():
    """What others sent in it has left the window by then."""
    part = OwnPart(0.0, (WINDOW,), 2000)
    part.entitle(5.0, 6000)
    assert part.changes_at(5.0) == part.grows_at(5.0) == 5.0 + WINDOW
    assert (part.of(5.9), part.of(5.0 + WINDOW)) == (0.2, 0.6)
    part.entitle(7.0, 1000)
    assert part.of(7.0) == 0.1


def test_what_was_sent_in_a_slot_does_not_count_when_it_is_passed_on():
    """It leaves the window with the room; so small messages go on."""
    part = OwnPart(0.0, (WINDOW,), 5000)
    part.sent(5.0, (0.4,))
    part.sent(5.1, (0.05,))
    assert part.spent(5.2, 4000)
    assert part.give_up(5.2, 1000, 4000, 1000) == 5.0
    assert part.free(5.2) == pytest.approx(0.05)
    assert part.of(5.2) == pytest.approx(0.5)
    assert part.changes_at(5.2) == 5.0 + WINDOW


def test_a_message_of_several_windows_is_busy_until_all_of_it_would_have_fitted():
    """Nothing else fits before."""
    part = OwnPart(0.0, (WINDOW,), UNIT // 2)
    part.sent(5.0, (1.5,), 3.0)
    assert part.busy_until == 5.0 + 2.0 * WINDOW
    assert part.free(5.0 + 2.9 * WINDOW) == 0.0
    assert part.free(5.0 + 3.1 * WINDOW) == 0.5
