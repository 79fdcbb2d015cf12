"""What samples and digests of another robot tell of the way to us."""

import pytest

from proxy.core.protocol.messages import Digest
from proxy.core.transit.tuning import TUNING
from proxy.core.view.peer import Peer
from tests.proxy.core.transit.heard import KEY, hear, hear_digest, news, state

LATER = 1.0
"""News come so long after what they tell of was sent [s]."""


def test_samples_tell_what_they_take_by_their_size(peer):
    """Their timestamp is read through the peer's wall clock and clock offset."""
    for at in range(2, 12):
        hear(peer, float(at), 0.1, size=100)
        hear(peer, at + 0.5, 0.3, size=10_100)
    assert peer.inbound.latency.fixed == pytest.approx(0.098, abs=1e-3)
    assert peer.inbound.latency.per_byte == pytest.approx(0.2 / 10_000, rel=0.01)
    assert peer.inbound.line.of(5_100) == pytest.approx(0.2, abs=1e-3)


def test_digests_tell_as_long_as_there_are_no_samples(peer):
    """First the quickest round trip, then what they take."""
    assert peer.inbound.latency is None
    assert peer.inbound.line.of(1000) == peer.outbound.line.of(1000) == pytest.approx(0.01, abs=1e-3)
    for at in (2.0, 3.0):
        hear_digest(peer, at)
    assert peer.inbound.latency.fixed == pytest.approx(0.01, abs=1e-3)
    for at in (4.0, 5.0, 6.0, 8.5):
        hear(peer, at, 0.1)
    assert peer.inbound.latency.fixed == pytest.approx(0.1, abs=1e-3)


def test_before_the_first_echo_nothing_is_known():
    """How far the clocks are from each other is not, so no sample tells its age."""
    peer = Peer("r2", "z-r2", 0.0)
    peer.take_state(0.0, state(1000.0))
    for at in range(5):
        peer.heard_digest(at + 0.01, Digest("r2", "z-r2", at - 100.0, 0, 0))
        peer.inbound.heard_digest(at + 0.01, at - 100.0, 150)
        hear(peer, at + 0.5, 0.1)
    assert peer.inbound.latency is peer.inbound.line is peer.outbound.line is None
    assert (peer.inbound.samples, peer.inbound.implausible) == (5, 0)


def test_the_wait_before_sending_is_no_latency(peer):
    """News of a stream whose last sample was the one sent tells how long it waited."""
    for at in range(2, 12):
        hear(peer, at + 0.0, 0.25)
        peer.inbound.heard_news(at + 0.2 + LATER, KEY, news(at, at, at + 0.0, at + 0.2), counts=True)
    for at in range(12, 22):
        peer.inbound.heard_news(at + 0.2 + LATER, KEY, news(at + 1, at, at + 0.9, at + 0.2), counts=True)
        hear(peer, at + 0.0, 0.25)
    assert peer.inbound.latency.fixed == pytest.approx(0.05, abs=1e-3)


@pytest.mark.parametrize(("took", "forgotten"), [(5.0, True), (0.06, False)])
def test_what_was_learnt_in_a_queue_is_forgotten_when_no_sample_comes(peer, took, forgotten):
    """Who believes it sends none, so it would stay true; not where digests take about as long, nor while they come."""
    for at in range(2, 10):
        hear(peer, float(at), took)
    last = 9.0 + took
    hear_digest(peer, last + TUNING.unconfirmed_for - 0.1)
    assert peer.inbound.latency.fixed == pytest.approx(took, abs=1e-3)
    hear_digest(peer, last + TUNING.unconfirmed_for)
    assert peer.inbound.line.of(100) == pytest.approx(0.01 if forgotten else took, abs=1e-3)


@pytest.mark.parametrize("error", [10.0, -10.0, 60.0, -60.0, -1e9])
def test_a_step_of_its_wall_clock_makes_no_sample_older(peer, error):
    """Ages that cannot be are counted if it tells too late; else samples are read by what the clock showed."""
    for at in range(2, 12):
        hear(peer, float(at), 0.1)
    for at in range(12, 15):
        hear(peer, float(at), 0.1, error=error)
    assert peer.inbound.implausible == 1
    assert peer.inbound.latency.fixed == pytest.approx(0.1, abs=1e-3)
    peer.take_state(15.0, state(1000.0 + error))
    for at in range(15, 32):
        hear(peer, float(at), 0.2, error=error)
    assert peer.inbound.implausible == 1
    assert peer.inbound.latency.fixed == pytest.approx(0.2, abs=1e-3)


@pytest.mark.parametrize("error", [-3.0, 3.0])
def test_a_step_of_its_wall_clock_is_looked_at_anew_when_told(peer, error):
    """Samples of the last two seconds are read only then, by the clock that tells the likelier age."""
    for at in range(2, 12):
        hear(peer, float(at), 0.1)
    for at in range(7):
        hear(peer, 13.1 + 0.1 * at, 0.1 + 0.1 * at, size=10_000, error=error)
    peer.take_state(14.5, state(1000.0 + error))
    assert peer.inbound.implausible == 0
    assert peer.inbound.line.of(100) == pytest.approx(0.1, abs=1e-3)
    assert peer.inbound.line.of(10_000) == pytest.approx(0.4, abs=1e-3)


def test_what_rare_samples_took_is_remembered_until_more_are_missing(peer):
    """One every 15 s that takes 5 s: between two of them nothing is learnt."""
    for at in range(15, 120, 15):
        hear(peer, float(at), 5.0)
        hear_digest(peer, at + 19.0)
    assert peer.inbound.latency.fixed == pytest.approx(5.0, abs=1e-3)
    hear_digest(peer, 105.0 + 5.0 + 45.0)
    assert peer.inbound.line.of(100) == pytest.approx(0.01, abs=1e-3)


def test_a_sample_without_a_timestamp_is_not_compared_with_an_older_one(peer):
    """News of it says nothing of the clock."""
    for at in range(2, 12):
        hear(peer, float(at), 0.1)
    peer.inbound.heard_news(11.0 + LATER, KEY, news(10, 10, 11.0, 11.0), counts=True)
    for at in range(20, 30):
        peer.inbound.heard_sample(at + 0.1, KEY, 100, None)
    peer.inbound.heard_news(29.0 + LATER, KEY, news(20, 20, 29.0, 29.0), counts=True)
    assert not peer.inbound._streams[KEY].astray
    assert peer.inbound.latency.fixed == pytest.approx(0.1, abs=1e-3)


def test_an_application_with_a_clock_of_its_own_spoils_nothing(peer):
    """News tells when samples were sent; what their timestamps made us believe is forgotten, and they count again."""
    for at in range(2, 12):
        hear(peer, float(at), 0.1, error=-5.0)
    peer.inbound.heard_news(11.0 + LATER, KEY, news(10, 10, 11.0, 11.0), counts=True)
    assert peer.inbound.latency.fixed == pytest.approx(5.1, abs=1e-3)
    for at in range(12, 22):
        hear(peer, float(at), 0.1, error=-5.0)
    peer.inbound.heard_news(21.0 + LATER, KEY, news(20, 20, 21.0, 21.0), counts=True)
    assert peer.inbound.latency is None
    for at in range(22, 32):
        hear(peer, float(at), 0.1)
        peer.inbound.heard_news(at + LATER, KEY, news(at, at - 1, float(at), float(at)), counts=True)
    assert peer.inbound.latency.fixed == pytest.approx(0.1, abs=1e-3)


@pytest.mark.parametrize("error", [0.0, 0.3, -0.3, 60.0])
def test_when_a_sample_was_generated_no_timestamp_tells(peer, error):
    """What samples take and how long they wait does, so a clock that was set alters nothing."""
    for at in range(2, 12):
        hear(peer, float(at), 0.25)
        peer.inbound.heard_news(at + 0.05 + LATER, KEY, news(at, at, float(at), at + 0.05), counts=True)
    stamp = 12.0 - 100.0 + 1000.0 + error
    assert peer.inbound.heard_sample(12.25, KEY, 100, stamp) == pytest.approx((12.0, 12.05), abs=1e-3)
    assert peer.inbound.heard_sample(13.25, KEY, 100, None) == pytest.approx((13.0, 13.05), abs=1e-3)


def test_a_small_step_is_not_taken_for_a_quicker_way(peer):
    """The reading nearest to what such samples take is the likelier one."""
    for at in range(2, 12):
        hear(peer, float(at), 0.12)
    hear(peer, 12.0, 0.12)
    peer.take_state(13.0, state(1000.0 - 0.1))
    hear(peer, 13.5, 0.12, error=-0.1)
    hear(peer, 17.0, 0.12, error=-0.1)
    assert peer.inbound.implausible == 0
    assert peer.inbound.latency.fixed == pytest.approx(0.12, abs=1e-3)


def test_many_samples_are_read_sooner(peer):
    """What waits to be read is bounded."""
    for k in range(70):
        hear(peer, 2.0 + 0.01 * k, 0.1)
    assert peer.inbound.latency.fixed == pytest.approx(0.1, abs=1e-3)


def test_timestamps_that_stand_still_say_nothing(peer):
    """Zenoh's clock does while the wall clock, set back, is behind it."""
    for at in range(10):
        hear(peer, 2.0 + at * 1e-7, 0.1 + at)
    assert peer.inbound.implausible == 9
    assert peer.inbound.latency is None


def test_loss_from_it_is_what_it_says_it_sent_and_did_not_come(peer):
    """Of streams that we get whole; another mode or other specs begin a new past."""
    for count in range(101):
        if count % 4:
            hear(peer, 2.0 + count, 0.1)
        if count % 10 == 0:
            told = news(count, count, 2.0 + count, 2.0 + count)
            peer.inbound.heard_news(2.0 + count + LATER, KEY, told, counts=True)
            peer.inbound.heard_news(2.0 + count + LATER, "other", told, counts=False)
    assert peer.inbound.losses.share == pytest.approx(0.25)
    peer.take_state(200.0, state(1000.0, mode="shadow"))
    assert peer.inbound.losses.share is None


def test_the_last_sample_that_was_sent_may_be_under_way(peer):
    """It is lost only when it has taken much longer than samples do."""
    for count in range(1, 101):
        if count > 10:
            peer.inbound.heard_news(2.05 + count, KEY, news(count, count, 2.0 + count, 2.0 + count), counts=True)
        hear(peer, 2.0 + count, 0.1)
    assert peer.inbound.losses.counted == (89, 0)
    peer.inbound.heard_news(103.0 + LATER, KEY, news(101, 101, 103.0, 103.0), counts=True)
    assert peer.inbound.losses.counted[1] == 1


def test_streams_of_a_peer_are_bounded(peer):
    """Samples of too many are counted, and tell nothing more."""
    for number in range(TUNING.streams + 10):
        peer.inbound.heard_sample(2.0, f"robot/{number}/camera", 100, None)
        peer.inbound.heard_news(1.0 + LATER, f"robot/{number}/camera", news(1, 1, 1.0, 1.0), counts=True)
    assert peer.inbound.samples == TUNING.streams + 10
    assert len(peer.inbound._streams) == TUNING.streams


def test_of_too_many_streams_the_one_not_heard_of_for_longest_is_forgotten(peer):
    """And counted: however many keys a robot had, what it sends now tells of its ways."""
    for number in range(TUNING.streams + 1):
        peer.inbound.heard_sample(2.0, f"robot/r2/old/{number}", 100, None)
    assert peer.evicted == 1
    for at in range(3, 13):
        hear(peer, float(at), 0.1)
        peer.inbound.heard_news(at + LATER, KEY, news(at, at, float(at), float(at)), counts=True)
    assert peer.inbound.latency.fixed == pytest.approx(0.1, abs=1e-3)
    assert peer.inbound.losses.share == 0.0
    assert peer.evicted == 2


def test_timestamps_that_its_robot_does_not_go_by_tell_nothing(peer):
    """It takes samples that are older than a second for new. News tell when one was made before it comes, as a rule."""
    for at in range(2, 12):
        peer.inbound.heard_news(at + 0.01, KEY, news(2 * at, at, float(at), float(at)), counts=True)
        hear(peer, float(at), 0.1, error=-1.5)
        peer.inbound.heard_news(at + LATER, KEY, news(2 * at + 1, at, at + 0.5, float(at)), counts=True)
    hear_digest(peer, 14.0)
    assert peer.inbound._streams[KEY].astray
    assert peer.inbound.line.of(100) == pytest.approx(0.01, abs=1e-3)
