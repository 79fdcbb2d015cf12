"""The shared view: streams, peers, origins, bounded."""

from dataclasses import replace

import pytest

from proxy.core.model.settings import CoreSettings, broadcast
from proxy.core.protocol.messages import Digest, Echo, State, StreamDigest
from proxy.core.view.tuning import TUNING
from proxy.core.view.view import SharedView
from tests.proxy.core.view.met import digest, join, lose, meet, team

GROUP = broadcast("224.0.0.226:7449")


@pytest.mark.parametrize("sent", [1.0, 0.5])
def test_a_digest_heard_twice_or_late_changes_nothing(view, sent):
    """Replays and reordering are harmless."""
    meet(view)
    assert view.heard_digest(1.0, digest(1.0))
    assert not view.heard_digest(2.0, digest(sent, StreamDigest(7, 9, 9, 1.0, 1.0, 10, 1.0)))
    assert list(view.streams) == []


def test_strangers_are_not_listened_to(view):
    """A digest or a state of a robot without a presence token changes nothing."""
    assert not view.heard_digest(1.0, digest(1.0))
    view.heard_state(1.0, State("r2", "z-r2", "enforce", ""))
    assert view.peers == {}
    assert view.add_peer(0.0, "r2", "z-r2")
    assert not view.add_peer(0.0, "r2", "z-r2")


def test_peers_are_bounded(view, monkeypatch):
    """Of a flood of tokens those that say nothing leave first; who speaks stays."""
    monkeypatch.setattr("proxy.core.view.view.TUNING", replace(TUNING, peers=3))
    meet(view)
    for number in range(10):
        assert view.add_peer(0.0, "x", f"x{number}")
    assert list(view.peers) == ["z-r2", "x8", "x9"]
    assert view.evicted == 8
    for zid in ("x8", "x9"):
        view.heard_state(0.0, State("x", zid, "", ""))
    assert not view.add_peer(0.0, "y", "y1")
    assert view.evicted == 9


def test_samples_for_a_robot_are_counted_when_they_are_handed_over(make_specs):
    """In unicast those that it wants, in broadcast all."""
    view = team(make_specs())
    view.streams.touch(0.0, "r1", "robot/r1/camera")
    view.heard_state(0.0, State("r4", "z-r4", "enforce", "", (), ("else",)))
    view.handed("robot/r1/camera")
    view.handed("no/such")
    assert [peer.outbound.sent for peer in view.peers.values()] == [1, 1, 0]
    air = SharedView(CoreSettings("r1", "z-r1", transport=GROUP), make_specs())
    join(air, "r2", transport=GROUP)
    air.handed("no/such")
    assert [peer.outbound.sent for peer in air.peers.values()] == [1]


def test_losses_with_other_specs_are_unknown(make_specs):
    """A robot with other specs counts other samples."""
    view = team(make_specs())
    peer = view.peers["z-r2"]
    lose(peer, 100, 50)
    view.heard_digest(3.0, Digest("r2", "z-r2", 3.0, 0, 0))
    assert peer.outbound.losses.share == 0.5
    view.heard_state(3.0, State("r2", "z-r2", "enforce", "others"))
    view.heard_digest(4.0, Digest("r2", "z-r2", 4.0, 0, 0))
    assert peer.outbound.losses.share is None
    lose(peer, 100, 50)
    view.restart_losses()
    assert peer.outbound.losses.share is None


def test_digests_say_nothing_of_samples_that_are_broadcast(make_specs):
    """They go another way."""
    for transport, found in ((GROUP, None), ("unicast", 0.01)):
        view = SharedView(CoreSettings("r1", "z-r1", transport=transport), make_specs())
        join(view, "r2", transport=transport)
        for at in range(5):
            echoes = (Echo("z-r1", at, at + 0.01, 0, 0.0),)
            view.heard_digest(at + 0.02, Digest("r2", "z-r2", at + 0.01, 0, 0, (), echoes))
        line = view.peers["z-r2"].inbound.latency
        assert line is None if found is None else line.fixed == pytest.approx(found, abs=1e-3)
        assert view.echoes.due(20.0)[0].latency == pytest.approx(found or 0.0, abs=1e-3)
