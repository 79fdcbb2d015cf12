"""When there is room: what we sent leaves the windows one after the other, and keeps the channel busy meanwhile."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import Constraint
from planner.measures import Throughput
from proxy.core.market.room import Departures, OwnDepartures, SendLog, at_pace, carried, pace_part
from proxy.core.market.tuning import TUNING
from proxy.core.model.limits import Limit, limits_of
from proxy.core.protocol.messages import Echo
from proxy.core.transit.latency import Latency
from proxy.core.view.stream import Generated
from tests.proxy.core.view.met import team

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


@given(SENDS, SENDS, st.floats(0.0, 2.0))
def test_many_sends_at_once_are_summed_up_as_one_after_the_other(before, later, since):
    """Whenever each was, and whatever is told of first."""
    once, singly = SendLog(), SendLog()
    once.add_all(sends(*before))
    once.add_all(sends(*later))
    for t, use in (*before, *later):
        singly.add(t, (use,))
    assert list(once) == list(singly)
    assert once.used(since, 0) == singly.used(since, 0)
    assert once.changes <= 2
    assert singly.changes == len(before) + len(later)


FRAME = 4000
PACED = Limit("throughput", 0.5, 5000.0, Throughput(10_000.0, 0.5))
PACED_SENDS = st.lists(st.tuples(st.floats(0.0, 5.0), st.tuples(st.floats(0.0, 5000.0))), max_size=8)


@pytest.fixture
def limits(make_specs):
    """10 kB in a second, nothing of it for digests."""
    return limits_of(make_specs(), 0.0, 1)


def test_samples_are_carried_one_after_the_other():
    """Each takes its part of what the limit gives it; what comes later begins later."""
    assert at_pace((1000.0,), (PACED,)) == pytest.approx(0.1)
    assert carried([(1.0, (1000.0,)), (1.0, (1000.0,))], (PACED,), 0.5) == pytest.approx(1.1)
    assert carried([(9.0, (1000.0,)), (1.0, (1000.0,))], (PACED,), 0.5) == pytest.approx(9.05)
    assert carried([], (PACED,), 0.5) == -math.inf


@given(PACED_SENDS, st.floats(0.0, 1.0))
def test_what_is_sent_besides_frees_the_channel_no_sooner(sends, part):
    """Whatever the order and the sizes."""
    assert carried(sends[1:], (PACED,), part) <= carried(sends, (PACED,), part)


@pytest.fixture
def view(make_specs):
    """Robots r2, r3 and r4 want our camera's frames of 4 kB."""
    view = team(make_specs())
    stream = view.streams.touch(0.0, "r1", "robot/r1/camera")
    stream.note_generated(1, Generated(0.0, FRAME, 1.0))
    return view


def test_a_sample_is_taken_to_be_carried_as_fast_as_receivers_tell(view, limits):
    """Beyond what digests take. Until they tell, and where that is little, nobody waits."""
    stream = view.streams.touch(0.0, "r1", "robot/r1/camera")
    assert pace_part(view, stream, limits) == 0.0
    copies = view.subscribers.copies(stream)
    view.peers["z-r2"].outbound.latency = Latency(0.01, 4e-5)
    slowest = at_pace((float(FRAME * copies),), limits)
    assert pace_part(view, stream, limits) == pytest.approx((0.01 + 4e-5 * FRAME) * copies / slowest)
    view.peers["z-r2"].offset.heard(1.0, 1.01)
    view.peers["z-r2"].offset.echoed(1.0, 1.01)
    assert pace_part(view, stream, limits) == pytest.approx(4e-5 * FRAME * copies / slowest)
    view.peers["z-r2"].outbound.latency = Latency(0.01, 1e-5)
    assert pace_part(view, stream, limits) == 0.0


def test_what_limits_allow_is_carried_however_long_samples_took(view, limits):
    """What they took holds waits behind others, too."""
    view.peers["z-r2"].outbound.heard_echo(1.0, Echo("z-r1", 0.0, 0.0, 3, 0.0, 0.01))
    assert pace_part(view, view.streams.touch(0.0, "r1", "robot/r1/camera"), limits) == TUNING.paced
