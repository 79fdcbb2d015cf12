"""Whom we echo, and what echoes tell of clocks and ways."""

import pytest

from proxy.core.interface.events import SampleHeard
from proxy.core.protocol.messages import Digest, Echo, tag
from proxy.core.protocol.tuning import TUNING as BOUNDS
from proxy.core.view.tuning import TUNING
from tests.proxy.core.view.met import CAMERA, digest, meet


def test_echoes_give_offset_and_latency(view):
    """What the peer says of our digest and our samples is kept."""
    meet(view)
    echo = Echo("z-r1", 9.0, -90.9, 12, 0.25)
    view.heard_digest(10.1, digest(-90.0, echoes=(echo, Echo("z-xx", 0.0, 0.0, 0, 0.0))))
    peer = view.peers["z-r2"]
    assert peer.offset.offset == pytest.approx(100.0, abs=1e-3)
    assert peer.offset.latency == pytest.approx(0.1)
    assert (peer.outbound.received, view.paths.of("r1").mean.of(0.0)) == (12, 0.25)
    assert view.paths.of("r2").mean.of(0.0) == pytest.approx(0.1)
    assert view.paths.of("unknown").mean.of(0.0) == 0.0
    (back,) = view.echoes.due(3.0)
    assert (back.peer, back.sent, back.received) == ("z-r2", -90.0, 10.1)


def test_no_way_is_told_to_take_longer_than_others_read(view):
    """Digests of ours that echo a robot whose clock stands a day back would be unreadable to all."""
    meet(view)
    view.heard_digest(10.0, digest(9.5, echoes=(Echo("z-r1", 9.0, 9.0, 0, 0.0),)))
    for _ in range(8):
        view.peers["z-r2"].restart()
        view.heard_digest(10.5, digest(-86400.0))
    assert [echo.latency for echo in view.echoes.due(11.0)] == [BOUNDS.latency]


def test_nobody_has_heard_what_is_yet_to_come(view):
    """A digest that echoes one from after it was sent tells nothing of the way."""
    meet(view)
    view.heard_digest(10.0, digest(9.5, echoes=(Echo("z-r1", 9.0, 9.6, 0, 0.0),)))
    assert not view.peers["z-r2"].offset.known
    view.heard_digest(10.1, digest(9.6, echoes=(Echo("z-r1", 9.0, 9.6, 0, 0.0),)))
    assert view.peers["z-r2"].offset.known


def test_samples_of_a_peer_are_counted_for_it(view):
    """With the last digest we tell how many had come by then; without a digest we know nobody."""
    meet(view)
    view.overhearing.take(SampleHeard(4.0, CAMERA, 100, "z-r2", None, None))
    view.heard_digest(5.0, digest(5.0))
    view.overhearing.take(SampleHeard(6.3, CAMERA, 100, "z-r2", None, None))
    assert [echo.samples for echo in view.echoes.due(3.0)] == [0]
    view.heard_digest(7.0, digest(7.0))
    assert [echo.samples for echo in view.echoes.due(3.0)] == [1]
    view.add_peer(11.0, "r3", "z-r3")
    assert [echo.peer for echo in view.echoes.due(11.0)] == ["z-r2"]


def test_the_quickest_digest_since_the_last_echo_tells_most_of_clocks(view):
    """Others waited somewhere; what came long ago says less, as clocks drift."""
    meet(view)
    for sent, took in ((5.0, 0.3), (6.0, 0.02), (7.0, 0.2)):
        view.heard_digest(sent + took, digest(sent))
    assert [echo.sent for echo in view.echoes.due(8.0)] == [7.0]
    assert [echo.sent for echo in view.echoes.due(8.0, quickest=True)] == [6.0]
    view.echoes.sent(["z-r2"])
    assert [echo.sent for echo in view.echoes.due(8.0, quickest=True)] == [7.0]
    view.heard_digest(9.1, digest(9.0))
    view.heard_digest(1009.2, digest(1009.0))
    assert [echo.sent for echo in view.echoes.due(1010.0, quickest=True)] == [1009.0]


def test_in_a_large_team_who_has_just_met_is_not_echoed(view):
    """Its digests wait while it starts."""
    meet(view)
    for number in range(TUNING.peers_always_echoed):
        view.add_peer(10.0, f"r{number + 3}", f"z-r{number + 3}")
    for name, now in (("r2", 10.1), ("r3", 10.2)):
        view.heard_digest(now, Digest(name, tag(f"z-{name}"), now))
    assert [echo.peer for echo in view.echoes.due(10.5)] == [tag("z-r2")]
    assert [echo.peer for echo in view.echoes.due(10.0 + TUNING.unechoed_after_meeting)] == [tag("z-r2"), tag("z-r3")]


def test_who_knows_no_way_yet_is_echoed_first(view):
    """By what all echo, so that soon everybody knows one; of equal ones each robot begins with another one."""
    for name in ("r0", "r2", "r3"):
        view.add_peer(0.0, name, f"z-{name}")
    assert not view.echoes.are_awaited(3.0)
    for name in ("r0", "r2", "r3"):
        view.heard_digest(1.0, Digest(name, tag(f"z-{name}"), 1.0))
    assert [echo.peer for echo in view.echoes.due(3.0)] == [tag("z-r2"), tag("z-r3"), tag("z-r0")]
    view.heard_digest(3.0, Digest("r3", tag("z-r3"), 3.0, echoes=(Echo(tag("z-r2"), 1.0, 1.0, 0, 0.0),)))
    assert [echo.peer for echo in view.echoes.due(3.0)] == [tag("z-r3"), tag("z-r0"), tag("z-r2")]
    assert view.echoes.are_awaited(3.0)
    view.echoes.sent([tag("z-r3"), tag("z-r0")])
    assert not view.echoes.are_awaited(3.0)


def test_ways_that_nobody_echoed_are_taken_to_be_as_long_as_the_shortest_one_known(view):
    """What others sent was sent before it was heard of, and what they send takes as long."""
    for name in ("r2", "r3", "r4"):
        view.add_peer(0.0, name, f"z-{name}")
    for name, took in (("r2", 0.1), ("r3", 0.3)):
        echo = Echo("z-r1", 9.0, 9.0 + took, 0, 0.0)
        view.heard_digest(10.0, Digest(name, tag(f"z-{name}"), 10.0 - took, echoes=(echo,)))
    view.heard_digest(10.0, Digest("r4", tag("z-r4"), 10.0))
    view.add_peer(10.0, "r5", "z-r5")
    ways = {peer.robot: (peer.offset.latency, peer.offset.known) for peer in view.peers.values()}
    assert ways["r4"] == ways["r5"] == (pytest.approx(0.1), False)
    assert ways["r3"] == (pytest.approx(0.3), True)
    assert view.peers[tag("z-r4")].offset.ours(10.0) == pytest.approx(9.9)
    assert view.paths.of("r4").mean.of(0.0) == pytest.approx(0.1)
