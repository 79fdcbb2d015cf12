"""The ways of messages between robots, as far as this one knows."""

import pytest

from proxy.core.protocol.messages import Digest, Echo
from proxy.core.transit.latency import Latency
from proxy.core.view.audience import Way
from tests.proxy.core.view.met import lose, team


@pytest.fixture
def view(make_specs):
    """Robots r2, r3 and r4 want all cameras, as we do."""
    return team(make_specs())


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
