"""Where samples wait: bounded in samples and bytes, with a place for a sample of any size."""

import threading
from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from proxy.bridge import room as room_module
from proxy.bridge.room import Room, rooms
from proxy.bridge.tuning import TUNING
from tests.waiting import wait_until


@given(st.lists(st.integers(0, 300), max_size=40), st.integers(1, 10), st.integers(2, 100))
def test_what_is_let_in_keeps_the_bounds_and_an_empty_room_takes_all(sizes, most, most_bytes):
    """One sample counts as at most half of the bytes; what all give back is all there was."""
    room, inside = Room(most, most_bytes), []
    for size in sizes:
        if room.enter(size):
            inside.append(size)
        else:
            assert inside
        counted = sum(min(each, most_bytes // 2) for each in inside)
        assert len(inside) <= most
        assert counted <= most_bytes
        assert room.crowded == (len(inside) > most // 2 or counted > most_bytes // 2)
        assert room.describe() == {"samples": len(inside), "bytes": sum(inside)}
    for size in inside:
        room.leave(size)
    assert room.describe() == {"samples": 0, "bytes": 0}
    assert room.enter(1000)


def test_who_lingers_goes_on_when_others_have_left(monkeypatch):
    """Or when a moment is over."""
    room = Room(4, 1000)
    for _ in range(3):
        room.enter(1)
    room.linger(1)
    assert room.crowded
    monkeypatch.setattr(room_module, "TUNING", replace(TUNING, catch_up=60.0))
    bringing = threading.Thread(target=room.linger, args=(1,))
    bringing.start()
    wait_until(lambda: room._waiting, what="somebody who lingers")
    room.leave(1)
    bringing.join(10.0)
    assert not bringing.is_alive()


def test_those_that_pass_take_no_place_from_those_to_be_decided():
    """Each kind has the same bounds for itself."""
    both = rooms(1, 1000)
    assert both.passing.enter(1)
    assert both.covered.enter(1)
    one = {"samples": 1, "bytes": 1}
    assert both.describe() == {"covered": one, "passing": one, "most": {"samples": 1, "bytes": 1000}}
