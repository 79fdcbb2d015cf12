"""What another robot tells of the way to it."""

import pytest

from proxy.core.protocol.messages import Echo
from proxy.core.transit.latency import Latency
from proxy.core.transit.outbound import latency_of


def test_loss_to_it_is_what_had_not_arrived_when_it_heard_our_digest(peer):
    """Its echo says which digest."""
    for at, sent, received in ((10.0, 0, 0), (11.0, 30, 27), (12.0, 60, 54)):
        peer.outbound.sent = sent
        peer.outbound.sent_digest(at)
        peer.outbound.sent += 7  # these are not in the digest
        peer.outbound.heard_echo(at + 0.02, Echo("z-r1", at, at - 99.99, received, 0.2, 1e-6))
    assert peer.outbound.loss == pytest.approx(0.1)
    assert peer.outbound.line.of(1000) == pytest.approx(0.201)
    assert peer.outbound.latency == Latency(0.2, 1e-6)
    assert peer.outbound.received == 54
    peer.outbound.heard_echo(13.0, Echo("z-r1", 12.5, -87.4, 60, 0.2))
    assert peer.outbound.loss == pytest.approx(0.1), "an echo of what we never sent tells no loss"
    peer.outbound.heard_echo(13.0, Echo("z-r1", 99.0, -87.4, 99, 0.9))
    assert peer.outbound.received == 60, "an echo from the future is none"


@pytest.mark.parametrize(
    ("latency", "per_byte"), [(0.0, 0.0), (-1.0, 1e-6), (1e9, 0.0), (0.1, 1e30), (0.1, float("inf")), (0.1, -1e-3)]
)
def test_what_an_echo_tells_that_cannot_be_is_not_believed(peer, latency, per_byte):
    """Nor does nothing at all mean that samples take no time."""
    peer.outbound.heard_echo(2.0, Echo("z-r1", 1.9, -98.1, 0, latency, per_byte))
    assert peer.outbound.latency is None
    assert latency_of(Echo("z-r3", 1.9, -98.1, 0, 0.0, 1e-6)) == Latency(0.0, 1e-6)
