"""The ways of messages between robots, as far as this one knows."""

import pytest

from proxy.core.model.settings import CoreSettings
from proxy.core.model.transport import broadcast
from proxy.core.protocol.messages import Digest, Echo, State
from proxy.core.transit.latency import Latency
from proxy.core.view.receivers import Way
from proxy.core.view.stream import Generated
from proxy.core.view.tuning import TUNING
from proxy.core.view.view import SharedView

GROUP = broadcast("224.0.0.226:7449")


@pytest.fixture
def view(make_specs):
    """Robots r2, r3 and r4 want all cameras, as we do."""
    made = SharedView(CoreSettings("r1", "z-r1"), make_specs())
    made.subscribers.set_own(("robot/**",))
    for robot in ("r2", "r3", "r4"):
        meet(made, robot)
    return made


def ways(view, stream, size):
    gaining = view.subscribers.gaining(stream)
    return view.paths.of(stream.robot).ways(gaining, size, view.paths.mean_loss())


def meet(view, robot, **rest):
    view.add_peer(0.0, robot, f"z-{robot}")
    state = State(robot, f"z-{robot}", "enforce", view.specs.generation, (), ("robot/**",), **rest)
    view.heard_state(0.0, state)


def lose(peer, sent, received):
    """Of so many samples only so many come."""
    for at, out, came in ((1.0, 0, 0), (2.0, sent, received)):
        peer.outbound.sent = out
        peer.outbound.sent_digest(at)
        peer.outbound.heard_echo(at, Echo("z-r1", at, at, came, 0.0))


def test_our_own_ways_are_what_the_receivers_tell(view):
    """Else what digests took there and back, else the mean of what is known."""
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    assert ways(view, own, 100) == [Way(0.0)] * 3
    view.peers["z-r2"].outbound.latency = Latency(0.15, 1e-3)
    view.peers["z-r3"].offset.heard(1.0, 1.05)
    assert [way.latency for way in ways(view, own, 100)] == pytest.approx([0.25, 0.25, 0.25])
    view.peers["z-r3"].offset.echoed(1.0, 1.05)
    assert [way.latency for way in ways(view, own, 100)] == pytest.approx([0.25, 0.05, 0.15])
    assert view.paths.of("r1").mean.of(100) == pytest.approx(0.15)
    assert view.paths.of("r1").mean.per_byte == pytest.approx(0.5e-3)


def test_ways_of_others_are_what_their_receivers_tell(view):
    """Us, and whoever echoes them in its digests."""
    camera = view.streams.touch(0.0, "r2", "robot/r2/camera")
    echoes = (Echo("z-r2", 0.0, 0.0, 0, 0.3, 1e-3), Echo("z-xx", 0.0, 0.0, 0, 0.9), Echo("z-r4", 0.0, 0.0, 0, 0.0))
    view.heard_digest(1.0, Digest("r3", "z-r3", 1.0, 0, 0, (), echoes))
    for at in range(3):
        view.peers["z-r2"].inbound._samples.observe(float(at), 100, 0.1)
    assert [way.latency for way in ways(view, camera, 100)] == pytest.approx([0.1, 0.4, 0.25])
    assert view.subscribers.of(camera) == ("z-r1", "z-r3", "z-r4")
    assert view.paths.of("r2").mean.of(100) == pytest.approx(0.25)
    assert view.paths.of("nobody").mean.of(100) == 0.0
    assert view.peers["z-r2"].heard_by == {"z-r3": Latency(0.3, 1e-3)}
    view.gone("z-r3")
    assert view.peers["z-r2"].heard_by == {}


def test_few_samples_of_many_robots_tell_the_mean_loss(view):
    """Each of them alone tells little."""
    for name in ("z-r2", "z-r3", "z-r4"):
        lose(view.peers[name], 10, 7)
    assert view.peers["z-r2"].outbound.loss == pytest.approx(0.15)
    assert view.paths.mean_loss() == pytest.approx(0.3)


def test_loss_is_of_each_way_and_the_mean_where_unknown(view):
    """A robot that gets nothing is not given up."""
    own, other = view.streams.touch(0.0, "r1", "robot/r1/camera"), view.streams.touch(0.0, "r2", "robot/r2/camera")
    assert view.paths.mean_loss() == 0.0
    lose(view.peers["z-r2"], 100, 80)
    lose(view.peers["z-r3"], 100, 0)
    assert view.paths.mean_loss() == pytest.approx(0.6)
    assert [way.share for way in ways(view, own, 100)] == pytest.approx([0.8, 0.05, 0.4])
    assert [way.share for way in ways(view, other, 100)] == pytest.approx([0.4, 0.8])
    view.peers["z-r2"].inbound._losses.read(0, 0)
    view.peers["z-r2"].inbound._losses.read(100, 90)
    assert next(way.share for way in ways(view, other, 100)) == pytest.approx(0.9)


def test_a_plain_node_gets_things_like_the_others(view):
    """Nothing is known of it but that it is there."""
    camera = view.streams.touch(0.0, "?plain", "robot/x/camera")
    assert ways(view, camera, 100) == [Way(0.0, 4.0)]


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
    assert ways(view, own, 100) == []
    assert view.audiences.of(1.0 + TUNING.ways_refresh, own).share == 1.0


def test_in_a_large_team_audiences_are_looked_at_anew_more_rarely(view):
    """There each is more work, and there are more of them."""
    for number in range(2 * TUNING.small_team - 3):
        meet(view, f"x{number}")
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


def test_samples_for_a_robot_are_counted_when_they_are_handed_over(view, make_specs):
    """In unicast those that it wants, in broadcast all."""
    view.streams.touch(0.0, "r1", "robot/r1/camera")
    view.heard_state(0.0, State("r4", "z-r4", "enforce", "", (), ("else",)))
    view.handed("robot/r1/camera")
    view.handed("no/such")
    assert [peer.outbound.sent for peer in view.peers.values()] == [1, 1, 0]
    air = SharedView(CoreSettings("r1", "z-r1", transport=GROUP), make_specs())
    meet(air, "r2", transport=GROUP)
    air.handed("no/such")
    assert [peer.outbound.sent for peer in air.peers.values()] == [1]


def test_losses_with_other_specs_are_unknown(view):
    """A robot with other specs counts other samples."""
    peer = view.peers["z-r2"]
    lose(peer, 100, 50)
    view.heard_digest(3.0, Digest("r2", "z-r2", 3.0, 0, 0))
    assert peer.outbound.loss == 0.5
    view.heard_state(3.0, State("r2", "z-r2", "enforce", "others"))
    view.heard_digest(4.0, Digest("r2", "z-r2", 4.0, 0, 0))
    assert peer.outbound.loss is None
    lose(peer, 100, 50)
    view.restart_losses()
    assert peer.outbound.loss is None


def test_digests_say_nothing_of_samples_that_are_broadcast(make_specs):
    """They go another way."""
    for transport, found in ((GROUP, None), ("unicast", 0.01)):
        view = SharedView(CoreSettings("r1", "z-r1", transport=transport), make_specs())
        meet(view, "r2", transport=transport)
        for at in range(5):
            echoes = (Echo("z-r1", at, at + 0.01, 0, 0.0),)
            view.heard_digest(at + 0.01, Digest("r2", "z-r2", float(at), 0, 0, (), echoes))
        line = view.peers["z-r2"].inbound.latency
        assert line is None if found is None else line.fixed == pytest.approx(found, abs=1e-3)
        assert view.echoes.due(20.0)[0].latency == pytest.approx(found or 0.0, abs=1e-3)
