"""What robots tell each other beyond what the limits leave to it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.gossip.excess import Excess

WINDOW, ALLOWED = 1.0, 100.0


def test_only_what_is_more_than_allowed_counts():
    """The first bytes of a window are what the limits leave to it."""
    excess = Excess()
    assert [excess.note(0.1 * n, 40.0, WINDOW, ALLOWED) for n in range(4)] == [0.0, 0.0, 20.0, 40.0]


def test_what_left_the_window_leaves_room():
    """Both of what was told and of what counted."""
    excess = Excess()
    assert excess.note(0.0, 150.0, WINDOW, ALLOWED) == 50.0
    assert excess.note(1.1, 100.0, WINDOW, ALLOWED) == 0.0


@given(st.lists(st.tuples(st.floats(0.0, 0.6), st.floats(1.0, 300.0)), max_size=60))
def test_samples_beside_what_counts_leave_room_for_all_that_was_told(told):
    """So the window that ends now never exceeds both together."""
    excess, now, noted = Excess(), 0.0, []
    for pause, size in told:
        now += pause
        noted.append((now, size, excess.note(now, size, WINDOW, ALLOWED)))
        within = [entry for entry in noted if entry[0] >= now - WINDOW]
        counted = sum(over for _, _, over in within)
        assert sum(size for _, size, _ in within) <= ALLOWED + counted + 1e-6
        assert all(over <= size for _, size, over in within)
    assert excess.note(now + 2.0, 1.0, WINDOW, ALLOWED) == pytest.approx(0.0)
