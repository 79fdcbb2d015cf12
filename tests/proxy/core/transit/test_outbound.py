"""What another robot tells of the way to it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.protocol.messages import Echo
from proxy.core.transit.latency import Latency
from proxy.core.transit.outbound import Loss, latency_of, share_of
from proxy.core.transit.tuning import TUNING


def test_loss_to_it_is_what_had_not_arrived_when_it_heard_our_digest(peer):
    """Its echo says which digest."""
    for at, sent, received in ((10.0, 0, 0), (11.0, 30, 27), (12.0, 60, 54)):
        peer.outbound.sent = sent
        peer.outbound.sent_digest(at)
        peer.outbound.sent += 7  # these are not in the digest
        peer.outbound.heard_echo(at + 0.02, Echo("z-r1", at, at - 99.99, received, 0.2, 1e-6))
    assert peer.outbound.losses.share == pytest.approx(0.1)
    assert peer.outbound.line.of(1000) == pytest.approx(0.201)
    assert peer.outbound.latency == Latency(0.2, 1e-6)
    assert peer.outbound.received == 54
    peer.outbound.heard_echo(13.0, Echo("z-r1", 12.5, -87.4, 60, 0.2))
    assert peer.outbound.losses.share == pytest.approx(0.1), "an echo of what we never sent tells no loss"
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


def test_nothing_sent_tells_nothing():
    """One reading is no difference, and neither are two of the same."""
    loss = Loss()
    assert loss.share is None
    loss.read(10, 10)
    loss.read(10, 10)
    assert loss.share is None


@given(st.integers(0, 10**9), st.integers(0, 10**9), st.integers(20, 1000), st.floats(0.0, 1.0))
def test_what_was_before_the_first_reading_does_not_matter(sent, received, more, part):
    """Counts may begin anywhere."""
    loss = Loss()
    loss.read(sent, received)
    came = round(more * part)
    loss.read(sent + more, received + came)
    assert loss.share == pytest.approx(1.0 - came / more)


@given(st.integers(0, 10_000), st.sampled_from([0.0, 0.05, 0.3]))
def test_a_loss_is_found(seed, rate):
    """To what chance and samples on their way make of it."""
    rng, loss = np.random.default_rng(seed), Loss()
    sent, came, waiting = 0, 0, 0
    for _ in range(TUNING.loss_readings):
        batch = int(rng.integers(5, 15))
        arrive = int(rng.binomial(batch, 1.0 - rate))
        sent, came, waiting = sent + batch, came + waiting, arrive  # each batch arrives by the next reading
        loss.read(sent, came)
    assert loss.share == pytest.approx(rate, abs=0.15)


def test_few_samples_may_still_be_on_their_way():
    """Two of three that have not come are not two thirds."""
    loss = Loss()
    loss.read(0, 0)
    loss.read(3, 1)
    assert loss.share == pytest.approx(0.1)


def test_more_received_than_sent_is_no_loss():
    """They were on their way before."""
    loss = Loss()
    loss.read(0, 0)
    loss.read(10, 14)
    assert loss.share == 0.0


@pytest.mark.parametrize("restarted", [(110, 3), (2, 95)])
def test_a_count_that_restarts_begins_a_new_past(restarted):
    """Whichever it is; so does being told."""
    loss = Loss()
    loss.read(0, 0)
    loss.read(100, 90)
    loss.read(*restarted)
    assert loss.share is None
    sent, received = restarted
    loss.read(sent + 100, received + 50)
    assert loss.share == 0.5
    loss.restart()
    assert loss.share is None


def test_only_the_recent_past_counts():
    """A channel that recovers is believed after a while."""
    loss = Loss()
    for number in range(100):
        loss.read(10 * number, 5 * min(number, 50) + 10 * max(0, number - 50))
    assert loss.share == 0.0


def test_many_readings_of_few_samples_do_not_shorten_the_past():
    """Digests may come more often than samples."""
    loss = Loss()
    for number in range(400):
        loss.read(number // 4, number // 4 - number // 8)
    assert loss.share == pytest.approx(0.5, abs=0.01)
    assert loss._read[0] == (0, 0)
    assert len(loss._read) <= TUNING.loss_readings


def test_counts_tell_the_share():
    """A loss among few counts as one among more."""
    loss = Loss()
    assert (loss.counted, loss.share) == ((0, 0), None)
    loss.read(0, 0)
    loss.read(40, 30)
    assert (loss.counted, loss.share) == ((40, 10), share_of(40, 10)) == ((40, 10), 0.25)
    assert share_of(1, 1) == 1 / TUNING.fewest_samples
    assert share_of(0, 0) is None
