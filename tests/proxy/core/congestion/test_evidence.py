"""What a robot sees of the channel by digests."""

import math
import random

import pytest

from planner import Throughput
from planner.airtime import Airtime
from proxy.core.congestion.evidence import DeliveryRatio, Evidence, Liveness, Load
from proxy.core.congestion.tuning import TUNING
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


def spoken(every, until):
    """Robots that say something each so often, and are heard."""
    liveness = Liveness(0.0)
    for i in range(1, int(until / every) + 1):
        liveness.digest_sent(i * every)
        liveness.digest_received(i * every + 0.01)
        liveness.echo_received(i * every + 0.02)
    return liveness


def test_silence_is_when_nobody_is_heard():
    """For some seconds."""
    liveness = spoken(0.5, 20.0)
    for i in range(1, 8):
        liveness.digest_sent(20.0 + 0.5 * i)
    assert not liveness.silent(22.0)
    assert liveness.silent(23.5)


def test_silence_is_when_nobody_hears_us():
    """Although we hear the others."""
    liveness = spoken(0.5, 20.0)
    for i in range(1, 12):
        liveness.digest_sent(20.0 + 0.5 * i)
        liveness.digest_received(20.0 + 0.5 * i)
    assert liveness.silent(25.5)
    liveness.echo_received(25.5)
    assert not liveness.silent(25.5)


def test_that_nobody_can_afford_to_say_more_is_no_silence():
    """Until what was told is paid for; what is overdue is noticed all the same, as it may wait in a queue."""
    liveness = spoken(0.5, 20.0)
    liveness.digest_received(20.0, 0.0, 28.0)
    liveness.digest_received(20.01, 0.0, 25.0)
    for i in range(1, 24):
        liveness.digest_sent(20.0 + 0.5 * i)
    assert not liveness.silent(30.0)
    assert liveness.overdue(30.0, 0.1, 1)
    assert liveness.silent(32.5)


def test_that_all_owe_for_what_they_told_does_not_hide_that_nobody_hears_us():
    """Although we hear the others, of whom each digest is to be paid for."""
    liveness = spoken(0.5, 20.0)
    for i in range(1, 12):
        liveness.digest_sent(20.0 + 0.5 * i)
        liveness.digest_received(20.0 + 0.5 * i, 0.0, 25.0 + 0.5 * i)
    assert liveness.silent(25.5)


def test_what_is_overdue_is_noticed_before_silence():
    """Where all speak often; who seldom speaks does not expect much."""
    liveness = spoken(0.2, 20.0)
    assert not liveness.overdue(20.3, 0.1, 1)
    liveness.digest_sent(20.3)
    liveness.digest_sent(20.6)
    assert not liveness.overdue(20.7, 0.1, 1)
    assert liveness.overdue(20.7, 0.1, 2)
    assert liveness.overdue(21.0, 0.1, 1)
    assert not liveness.overdue(20.7, 0.4, 2)
    assert not liveness.silent(20.7)
    assert not spoken(4.0, 40.0).overdue(43.0, 0.1, 9)


def test_what_waited_on_its_way_is_no_fresh_news():
    """However much of it comes; nor is what overtook it forgotten."""
    liveness = spoken(0.2, 20.0)
    for tenth in range(1, 10):
        liveness.digest_sent(20.0 + tenth / 10.0)
        liveness.digest_received(20.0 + tenth / 10.0, tenth / 10.0)
    assert liveness.staleness(20.9) == pytest.approx(0.89)
    assert liveness.overdue(20.9, 0.1, 2)


def test_how_rarely_we_are_told_that_we_are_heard_is_learnt():
    """Where there are many each is told in its turn, but nobody waits for ever."""
    liveness = Liveness(0.0)
    for second in range(1, 41):
        liveness.digest_sent(float(second))
        liveness.digest_received(float(second))
        if second % 4 == 0:
            liveness.echo_received(float(second))
    for second in range(41, 48):
        liveness.digest_sent(float(second))
        liveness.digest_received(float(second))
    assert not liveness.silent(47.0)
    for second in range(48, 60):
        liveness.digest_sent(float(second))
        liveness.digest_received(float(second))
    assert liveness.silent(59.0)


def test_who_may_seldom_speak_expects_to_hear_seldom():
    """The allowance is the same for all."""
    liveness = spoken(4.0, 40.0)
    assert liveness.interval(42.0) == 4.0
    assert not liveness.silent(50.0)
    assert liveness.last_sent == 40.0


def test_nobody_who_came_late_was_silent():
    """Nobody was there to be heard."""
    liveness = Liveness(0.0)
    liveness.digest_sent(99.0)
    liveness.digest_sent(100.0)
    liveness.restart(100.0)
    assert not liveness.silent(101.0)


def flown(parts, *, every=0.5, rate=50, seed=0):
    """What was lost after each report of a flight in which such parts arrive."""
    delivery, dice = DeliveryRatio(), random.Random(seed)
    sent = arrived = 0
    losses = []
    for i, part in enumerate(parts):
        sent += rate
        arrived += sum(dice.random() < part for _ in range(rate))
        delivery.note(i * every, sent, "op", arrived)
        losses.append(delivery.excess_loss(i * every))
    return delivery, losses


@pytest.mark.parametrize("part", [1.0, 0.95, 0.7, 2.0])
def test_a_radio_that_always_loses_is_no_full_channel(part):
    """Nor does it matter how many of the others count what they hear."""
    _, losses = flown([part] * 100)
    assert max(losses) < TUNING.excess_loss


def reported(every, *, part, seconds=40.0, rate=40.0):
    """What seems lost at each report where robots share our messages and each reports on them this often."""
    delivery, losses = DeliveryRatio(), []
    reports = sorted((n * each, place) for place, each in enumerate(every) for n in range(1, int(seconds / each)))
    for now, place in reports:
        # Bursts: twice the rate in every other second.
        sent = round(rate * (now + 0.5 * math.sin(math.pi * now) / math.pi))
        delivery.note(now, sent, str(place), round(part * sent / len(every)))
        losses.append(delivery.excess_loss(now))
    return losses


@pytest.mark.parametrize("every", [(0.3, 1.9), (0.25, 0.7, 2.6), (0.5, 0.5, 0.5, 2.3)])
def test_that_robots_report_at_different_times_is_no_loss(every):
    """However long ago some of them did, and however much was sent since."""
    assert max(reported(every, part=0.99)) < 0.1


def test_of_what_a_robot_has_not_reported_on_nothing_is_known():
    """What others report meanwhile does not tell what arrived there."""
    delivery = DeliveryRatio()
    for second in range(20):
        delivery.note(second, 40 * second, "a", 20 * second)
        if second < 10:
            delivery.note(second, 40 * second, "b", 20 * second)
    assert delivery.excess_loss(19.0) == 0.0


def test_more_loss_than_usual_is_seen_within_seconds():
    """And forgotten once it is usual, or accepted."""
    delivery, losses = flown([0.95] * 30 + [0.4] * 10)
    assert max(losses[:30]) < TUNING.excess_loss < losses[-1]
    delivery.accept()
    assert delivery.excess_loss(20.0) == 0.0
    assert flown([0.95] * 30 + [0.4] * 100)[1][-1] < TUNING.excess_loss


def test_who_left_or_restarted_makes_counts_incomparable():
    """Nothing is known then, nor after silence, nor where nothing ever arrives."""
    delivery, _ = flown([0.95] * 30 + [0.4] * 10)
    assert delivery.excess_loss(19.5) > TUNING.excess_loss
    assert delivery.excess_loss(60.0) == 0.0
    delivery.note(20.0, 2050, "op", 0)
    assert delivery.excess_loss(20.0) == 0.0
    delivery.forget("nobody")
    assert flown([0.0] * 20)[1][-1] == 0.0


BYTES = Limit("bytes", 0.5, 50_000.0, Throughput(100_000.0))
HALF = Limit("air", 0.5, 0.5, Airtime(1.0, 125_000.0))


def test_the_part_of_a_limit_that_all_use_together():
    """Robots' rates add up, each by its own clock; counts that are no news change nothing."""
    load = Load()
    for t in range(5):
        load.note(t, "a", 1000.0 + t, 10 * t, 20_000 * t)
        load.note(t, "b", t, 5 * t, 5_000 * t)
    load.note(4.5, "b", 2.0, 999, 999_999)
    assert load.parts(4.5, [BYTES])[0] == pytest.approx(0.25)
    (air,) = load.parts(4.5, [HALF])
    assert air == pytest.approx(10 * HALF.measure.use(2000, 1, own=False) + 5 * HALF.measure.use(1000, 1, own=False))


def test_who_is_not_heard_or_has_left_uses_nothing():
    """Nothing is known of them."""
    load = Load()
    for t in range(3):
        load.note(t, "a", t, t, 10_000 * t)
        load.note(t, "b", t, t, 10_000 * t)
    load.forget("b")
    assert load.parts(2.0, [BYTES])[0] == pytest.approx(0.1)
    assert load.parts(9.0, [BYTES]) == (0.0,)


def test_one_count_is_no_rate():
    """Nor is one that restarted."""
    load = Load()
    load.note(0.0, "a", 0.0, 10, 100_000)
    assert load.parts(0.0, [BYTES]) == (0.0,)
    load.note(1.0, "a", 1.0, 0, 0)
    assert load.parts(1.0, [BYTES]) == (0.0,)
