"""When there is room: what we sent leaves the windows one after the other."""

import math

from hypothesis import given
from hypothesis import strategies as st

from planner import Constraint
from proxy.core.market.room import Departures, OwnDepartures, SendLog

LIMIT = Constraint("throughput", 1.0, 100.0)
SENDS = st.lists(st.tuples(st.floats(0.0, 2.0), st.floats(1.0, 60.0)), max_size=12)


def sends(*pairs):
    return [(t, (use,)) for t, use in pairs]


def test_room_opens_when_enough_of_what_we_sent_has_left_the_window():
    """Of two sends of 60 and 30 the first has to leave for 50 more."""
    room = Departures(sends((1.0, 60.0), (1.5, 30.0)), ()).opens((LIMIT,), (50.0,))
    assert 2.0 < room < 2.001


def test_there_is_room_now_where_all_fits():
    """And always where nothing limits anything."""
    assert Departures(sends((1.0, 60.0)), ()).opens((LIMIT,), (40.0,)) == -math.inf
    assert Departures((), ()).opens((), ()) == -math.inf


def test_nobody_waits_for_room_that_another_robot_leaves():
    """Several would."""
    assert Departures(sends((1.5, 30.0)), sends((1.0, 60.0))).opens((LIMIT,), (50.0,)) == math.inf


def test_there_is_never_room_for_more_than_a_limit():
    """Though nothing was sent."""
    assert Departures((), ()).opens((LIMIT,), (101.0,)) == math.inf


@given(own=SENDS, needed=st.floats(1.0, 100.0))
def test_when_it_opens_the_message_fits_and_just_before_it_does_not(own, needed):
    """By the closed window of Eq. 5."""
    room = Departures(sends(*own), ()).opens((LIMIT,), (needed,))

    def left(now):
        return LIMIT.limit - sum(use for t, use in own if t >= now - LIMIT.window)

    if room == -math.inf:
        assert left(2.0) >= needed or max(t for t, _ in own) <= 2.0
        assert sum(use for _, use in own) + needed <= LIMIT.limit
    else:
        assert left(room) >= needed - 1e-6
        assert left(room - 2e-6) < needed + 1e-6


@given(st.lists(st.tuples(st.integers(0, 200), st.integers(1, 60)), max_size=12), st.integers(1, 110))
def test_our_own_sends_say_the_same_without_a_sum(own, needed):
    """Where nobody else sent anything."""
    log = SendLog()
    for t, use in own:
        log.add(t / 100, (float(use),))
    limits, use = (LIMIT,), (float(needed),)
    assert OwnDepartures(log, 0.0).opens(limits, use) == Departures(sorted(log), ()).opens(limits, use)
