"""How much was told lately, without summing it up."""

from hypothesis import given
from hypothesis import strategies as st

from proxy.core.gossip.recent_bytes import RecentBytes

WINDOW = 1.0


@given(
    st.lists(st.tuples(st.floats(0.001, 0.6), st.integers(1, 300)), max_size=40),
    st.floats(0.0, 2.0),
    st.integers(0, 600),
)
def test_it_says_how_much_is_in_a_window_and_when_there_is_room(told, later, room):
    """As adding it all up says: the first moment at which no more is left than there is room for."""
    recent, now, all_of_it = RecentBytes(), 0.0, []
    for pause, amount in told:
        now += pause
        recent.forget(now - WINDOW)
        recent.add(now, amount)
        all_of_it.append((now, amount))
        assert recent.total == sum(amount for t, amount in all_of_it if t >= now - WINDOW)

    def left(at):
        return sum(amount for t, amount in all_of_it if t > at - WINDOW and t + WINDOW > at)

    now += later
    at = recent.fits_at(now, WINDOW, room)
    assert at >= now
    assert left(at) <= room
    earlier = [t + WINDOW for t, _ in all_of_it if now <= t + WINDOW < at]
    assert all(left(t) > room for t in earlier)
