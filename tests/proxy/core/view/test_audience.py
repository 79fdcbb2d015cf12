"""Those that gain by a stream, and when they are looked at anew."""

import pytest

from proxy.core.model.settings import CoreSettings
from proxy.core.transit.latency import Latency
from proxy.core.view.stream import Generated
from proxy.core.view.tuning import TUNING
from proxy.core.view.view import SharedView
from tests.proxy.core.view.met import join, team


@pytest.fixture
def view(make_specs):
    """Robots r2, r3 and r4 want all cameras, as we do."""
    return team(make_specs())


def test_an_audience_is_looked_at_anew_when_somebody_joins_or_after_a_while(view):
    """Not for every decision: with many robots that takes long."""
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    own.note_generated(1, Generated(0.0, 1000, 1.0))
    for peer in view.peers.values():
        peer.outbound.latency = Latency(0.1, 1e-5)
    audience = view.audiences.of(1.0, own)
    assert (audience.latency_of(1000), audience.latency_of(2000)) == pytest.approx((0.11, 0.12))
    view.peers["z-r2"].outbound.latency = Latency(0.4)
    assert view.audiences.of(1.1, own) is audience
    later = view.audiences.of(1.0 + TUNING.ways_refresh, own)
    assert (later.mean, later.slowest, later.share) == pytest.approx((0.62 / 3, 0.4, 3.0))
    view.gone("z-r2")
    assert view.audiences.of(1.0 + TUNING.ways_refresh, own).share == 2.0
    for robot in ("r3", "r4"):
        view.gone(f"z-{robot}")
    assert view.audiences.of(1.0 + TUNING.ways_refresh, own).share == 1.0


def test_in_a_large_team_audiences_are_looked_at_anew_more_rarely(view):
    """There each is more work, and there are more of them."""
    for number in range(2 * TUNING.small_team - 3):
        join(view, f"x{number}")
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    own.note_generated(1, Generated(0.0, 1000, 1.0))
    audience = view.audiences.of(1.0, own)
    view.peers["z-r2"].outbound.latency = Latency(0.4)
    assert view.audiences.of(1.0 + 1.9 * TUNING.ways_refresh, own) is audience
    assert view.audiences.of(1.0 + 2.1 * TUNING.ways_refresh, own).slowest == pytest.approx(0.4)


def test_streams_of_one_robot_have_one_audience_while_it_is_the_same(view):
    """Samples of another size have their own, and when it is time they are looked at together."""
    streams = [view.streams.touch(0.0, "r1", f"robot/{number}/camera") for number in range(3)]
    for stream, size in zip(streams, (1000, 1000, 2000), strict=True):
        stream.note_generated(1, Generated(0.0, size, 1.0))
    first, second, larger = (view.audiences.of(1.0, stream) for stream in streams)
    assert second is first
    assert larger is not first
    later = 1.0 + TUNING.ways_refresh
    assert view.audiences.of(later, streams[1]) is view.audiences.of(later, streams[0])


def test_audiences_are_bounded(make_specs):
    """Those of streams that there are no more are forgotten, and of sizes that were."""
    view = SharedView(CoreSettings("r1", "z-r1", streams=3), make_specs())
    for number in range(20):
        stream = view.streams.touch(float(number), "r1", f"robot/{number}/camera")
        stream.note_generated(1, Generated(0.0, number, 1.0))
        view.audiences.of(float(number), stream)
    assert len(view.audiences._known) <= 4
    assert len(view.audiences._common) <= 4
