"""What a robot sees of the channel by digests."""

import math

import pytest

from planner import Throughput
from proxy.core.congestion.evidence import Evidence
from proxy.core.model.limits import Limit
from proxy.core.protocol.messages import Digest, Echo

AIR = Limit("air", 0.5, 5e4, Throughput(1e5), 0.05)


def heard(waits, peers=("op",), back=0.0):
    """Peers send a digest every 0.1 s, which wait so long; echoes say that ours waited `back`."""
    evidence = Evidence(0.0, "us")
    for i, wait in enumerate(waits, 1):
        now = 0.1 * i
        evidence.digest_sent(now - 0.05, 10 * i)
        for peer in peers:
            echo = Echo("us", now - 0.05, now - 0.05 + back * i, 8 * i, 0.0)
            evidence.digest_received(now, Digest(peer, peer, now - wait, 10 * i, 1000 * i, echoes=(echo,)))
    return evidence, 0.1 * len(waits)


def queue(evidence, now, receivers=()):
    return evidence.queue(now, receivers, -math.inf, 0.1, 0.5)


def test_a_queue_before_what_comes_here_is_seen():
    """It is that of all paths."""
    evidence, now = heard([0.0] * 5 + [0.3] * 10)
    assert queue(evidence, now).delay == pytest.approx(0.3)
    assert queue(evidence, now, receivers=("other",)).delay == pytest.approx(0.3)


def test_a_queue_before_what_we_send_counts_where_our_receivers_are():
    """Echoes tell of it; of those to whom nothing goes it does not matter."""
    evidence, now = heard([0.0] * 20, back=0.02)
    assert queue(evidence, now, receivers=("op",)).delay > 0.1
    assert queue(evidence, now, receivers=("other",)).delay == pytest.approx(0.0)


def test_our_own_link_tells_of_robots_that_are_there():
    """Of others nothing is known."""
    evidence, now = heard([0.0] * 10)
    for i in range(8):
        evidence.link_gauged(now + 0.05 * i, "op", 0.05 * i)
        evidence.link_gauged(now + 0.05 * i, "unknown", 9.0)
    assert queue(evidence, now + 0.75).delay >= 0.1
    assert evidence.paths.keys() == {"op"}


def test_echoes_tell_what_arrives_and_counts_what_is_sent():
    """Both are of the digests that they echo."""
    evidence, now = heard([0.0] * 60)
    assert evidence.delivery.excess_loss(now) == pytest.approx(0.0)
    evidence.sent(0.0, 0, 0)
    evidence.sent(now, 60, 60_000)
    (part,) = evidence.load.parts(now, [AIR])
    assert part == pytest.approx(0.2, rel=0.01)


def test_who_left_is_no_evidence():
    """Nothing is known of its path, its load and what it received."""
    evidence, now = heard([0.0] * 5 + [0.3] * 10)
    evidence.forget("op")
    assert not evidence.paths
    assert queue(evidence, now) is None
    assert evidence.load.parts(now, [AIR]) == (0.0,)
