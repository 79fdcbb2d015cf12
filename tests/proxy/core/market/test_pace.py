"""How long what is sent keeps the channel busy."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.measures import Throughput
from proxy.core.market.room import at_pace, carried, pace_part
from proxy.core.market.tuning import TUNING
from proxy.core.model.limits import Limit, limits_of
from proxy.core.protocol.messages import Echo
from proxy.core.transit.latency import Latency
from proxy.core.view.stream import Generated
from tests.proxy.core.view.met import team

FRAME = 4000
LIMIT = Limit("throughput", 0.5, 5000.0, Throughput(10_000.0, 0.5))
SENDS = st.lists(st.tuples(st.floats(0.0, 5.0), st.tuples(st.floats(0.0, 5000.0))), max_size=8)


@pytest.fixture
def limits(make_specs):
    """10 kB in a second, nothing of it for digests."""
    return limits_of(make_specs(), 0.0, 1)


def test_samples_are_carried_one_after_the_other():
    """Each takes its part of what the limit gives it; what comes later begins later."""
    assert at_pace((1000.0,), (LIMIT,)) == pytest.approx(0.1)
    assert carried([(1.0, (1000.0,)), (1.0, (1000.0,))], (LIMIT,), 0.5) == pytest.approx(1.1)
    assert carried([(9.0, (1000.0,)), (1.0, (1000.0,))], (LIMIT,), 0.5) == pytest.approx(9.05)
    assert carried([], (LIMIT,), 0.5) == -math.inf


@given(SENDS, st.floats(0.0, 1.0))
def test_what_is_sent_besides_frees_the_channel_no_sooner(sends, part):
    """Whatever the order and the sizes."""
    assert carried(sends[1:], (LIMIT,), part) <= carried(sends, (LIMIT,), part)


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
