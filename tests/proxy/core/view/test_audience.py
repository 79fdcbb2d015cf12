"""Those that gain by a stream, and when they are looked at anew."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import Receiver
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import Digest, Echo
from proxy.core.transit.latency import Latency
from proxy.core.view.audience import Way, grouped
from proxy.core.view.stream import Generated
from proxy.core.view.tuning import TUNING
from proxy.core.view.view import SharedView
from tests.proxy.core.view.met import join, lose, team


@pytest.fixture
def view(make_specs):
    """Robots r2, r3 and r4 want all cameras, as we do."""
    return team(make_specs())


def test_an_audience_is_looked_at_anew_when_somebody_joins_or_after_a_while(view):
    """Not for every decision: with many robots that takes long."""
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    own.note_generated(1, Generated(0.0, 1024, 1.0))
    for peer in view.peers.values():
        peer.outbound.latency = Latency(0.1, 1e-5)
    audience = view.audiences.of(1.0, own)
    assert (audience.latency_of(1000), audience.latency_of(2000)) == pytest.approx((0.11, 0.12))
    view.peers["z-r2"].outbound.latency = Latency(0.4)
    assert view.audiences.of(1.1, own) is audience
    later = view.audiences.of(1.0 + TUNING.ways_refresh, own)
    assert (later.mean, later.slowest, later.share) == pytest.approx(((0.4 + 2 * 0.11024) / 3, 0.4, 3.0))
    view.gone(1.0, "z-r2")
    assert view.audiences.of(1.0 + TUNING.ways_refresh, own).share == 2.0
    for robot in ("r3", "r4"):
        view.gone(1.0, f"z-{robot}")
    assert view.audiences.of(1.0 + TUNING.ways_refresh, own).share == 1.0


def test_where_all_ways_are_taken_alike_only_the_mean_loss_counts(view):
    """What is known of a way by its own samples counts again where they are not."""
    own, other = (view.streams.touch(0.0, robot, f"robot/{robot}/camera") for robot in ("r1", "r2"))
    for stream in (own, other):
        stream.note_generated(1, Generated(0.0, 1000, 1.0))
    for name, sent, came in (("z-r2", 100, 100), ("z-r3", 20, 10), ("z-r4", 50, 45)):
        lose(view.peers[name], sent, came)
    known, mean = view.audiences.of(1.0, own).share, view.audiences.of(1.0, other).share
    assert known != pytest.approx(mean)
    view.audiences.take_alike(alike=True)
    each = [view.audiences.of(1.0, stream).share for stream in (own, other)]
    assert each == pytest.approx([3.0 * (1.0 - view.paths.mean_loss())] * 2)
    view.audiences.take_alike(alike=False)
    assert view.audiences.of(1.0, own).share == known


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


def test_equal_latencies_are_one_group():
    """To the millisecond; who hears first has no delay."""
    assert grouped([Way(0.02)]) == (0.02, (Receiver(0.0, 1.0),))
    latency, receivers = grouped([Way(0.0201), Way(0.1), Way(0.0199)])
    assert latency == pytest.approx(0.02)
    assert receivers == (Receiver(0.0, 2.0), Receiver(pytest.approx(0.08), 1.0))


def test_a_robot_counts_as_far_as_messages_get_to_it():
    """So does its latency within its group; where nothing gets, all count alike."""
    latency, receivers = grouped([Way(0.02, 0.75), Way(0.0204, 0.25)])
    assert latency == pytest.approx(0.0201)
    assert receivers == (Receiver(0.0, 1.0),)
    assert grouped([Way(0.01, 0.0), Way(0.0102, 0.0)]) == (pytest.approx(0.0101), (Receiver(0.0, 0.0),))


def test_too_many_groups_are_joined_where_they_are_closest():
    """At the mean of their robots."""
    latency, receivers = grouped(map(Way, [0.01, 0.02, 0.022, 0.0222, 0.1, 0.2]))
    assert latency == 0.01
    assert [r.share for r in receivers] == [1.0, 3.0, 1.0, 1.0]
    assert [r.delay for r in receivers] == pytest.approx([0.0, 0.0114, 0.09, 0.19])


@given(st.lists(st.tuples(st.floats(0.0, 5.0), st.floats(0.05, 1.0)), min_size=1, max_size=30))
def test_every_robot_counts_once_and_the_mean_latency_stays(drawn):
    """However they are grouped."""
    latency, receivers = grouped(Way(*way) for way in drawn)
    assert 1 <= len(receivers) <= TUNING.receiver_groups
    assert min(r.delay for r in receivers) == 0.0
    share = sum(share for _, share in drawn)
    assert sum(r.share for r in receivers) == pytest.approx(share)
    mean = latency + sum(r.delay * r.share for r in receivers) / share
    assert mean == pytest.approx(sum(took * part for took, part in drawn) / share)


def ways(view, stream, size):
    gaining = view.subscribers.gaining(stream)
    return view.paths.of(stream.robot).ways(gaining, size, view.paths.mean_loss())


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
    view.gone(1.0, "z-r3")
    assert view.peers["z-r2"].heard_by == {}


def test_how_long_a_sample_is_on_the_air_is_told_of_anybodys_samples(view):
    """All go by one channel; the median counts: who was told before its first large sample knows of digests alone."""
    assert view.paths.on_air(("z-r2",), 1000) is None
    view.peers["z-r3"].heard_by["z-r2"] = Latency(0.01, 1e-4)
    assert view.paths.on_air(("z-r2",), 1000) == pytest.approx(0.11)
    view.peers["z-r2"].outbound.latency = Latency(0.004)
    view.peers["z-r4"].heard_by["z-r2"] = Latency(0.01, 2e-4)
    assert view.paths.on_air(("z-r2",), 1000) == pytest.approx(0.11)
    assert view.paths.on_air(("z-r4",), 1000) is None


def test_few_samples_of_many_robots_tell_the_mean_loss(view):
    """Each of them alone tells little."""
    for name in ("z-r2", "z-r3", "z-r4"):
        lose(view.peers[name], 10, 7)
    assert view.peers["z-r2"].outbound.losses.share == pytest.approx(0.15)
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
    view.peers["z-r2"].inbound.losses.read(0, 0)
    view.peers["z-r2"].inbound.losses.read(100, 90)
    assert next(way.share for way in ways(view, other, 100)) == pytest.approx(0.9)


def test_a_plain_node_gets_things_like_the_others(view):
    """Nothing is known of it but that it is there."""
    camera = view.streams.touch(0.0, "?plain", "robot/x/camera")
    assert ways(view, camera, 100) == [Way(0.0, 4.0)]


def test_where_nobody_gains_there_is_no_way(view):
    """All robots left."""
    own = view.streams.touch(0.0, "r1", "robot/r1/camera")
    for robot in ("r2", "r3", "r4"):
        view.gone(1.0, f"z-{robot}")
    assert ways(view, own, 100) == []
