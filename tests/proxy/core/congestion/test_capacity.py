"""Adaptive limits follow the channel, by evidence that comes in digests."""

import math

import pytest

from planner import Throughput
from proxy.core.congestion.capacity import Capacity, Traffic
from proxy.core.congestion.tuning import TUNING
from proxy.core.model.limits import Limit
from proxy.core.protocol.messages import Digest, Echo

RATE = 100_000.0
AIR = Limit("air", 0.5, RATE * 0.5, Throughput(RATE), 0.05)
FIXED = Limit("fixed", 0.5, RATE, Throughput(2 * RATE))


class Channel:
    """A capacity whose peers speak every 0.1 s; `waits` by peer are what they see and say, None: nothing comes."""

    def __init__(self, peers=("op",), receivers=("op",)):
        self.capacity = Capacity(0.0, "us")
        self.capacity.set_limits(0.0, (FIXED, AIR))
        self.receivers, self.now, self.sent, self.dropped = receivers, 0.0, 0, 0
        self.waits = dict.fromkeys(peers, 0.0)
        self.tells = dict.fromkeys(peers, 1.0)
        self.arriving = 1.0
        self.use = 1.0
        self.drops = True
        self.hears_us = True
        self.leader = ""
        self.tells_use = ()

    def run(self, seconds):
        """Let the time pass; the channel is used by as much of the limit in force as `use` says."""
        for _ in range(round(seconds * 10)):
            self.now = round(self.now + 0.1, 6)
            self.sent += 1000 * self.use * self.factor * RATE * 0.1 / 1000
            self.dropped += self.drops
            self.capacity.evidence.sent(self.now, round(self.sent / 1000), round(self.sent))
            digest = Digest("us", "us", self.now - 0.05, round(self.sent / 1000), round(self.sent))
            self.capacity.reported(digest)
            for number, (peer, wait) in enumerate(self.waits.items()):
                if wait is not None:
                    self._speak(peer, wait, self.now - 0.001 * number, digest)
            if self.now >= self.capacity.due_at:
                self.capacity.look(self.now, Traffic(self.dropped, self.receivers, 0.0, (0.01,), (0.01,), self.leader))
        return self

    def _speak(self, peer, wait, now, ours):
        samples = round(self.sent / 1000 * self.arriving)
        echoes = (Echo("us", ours.sent, ours.sent + 500.0 + wait, samples, 0.0),) if self.hears_us else ()
        capacity = self.tells[peer], *self.tells_use
        told = Digest(peer, peer, now + 77.0 - wait, 0, 0, echoes=echoes, capacity=capacity)
        self.capacity.digest_received(now, told)

    @property
    def factor(self):
        (factor,) = self.capacity.factors
        return factor

    @property
    def why(self):
        return self.capacity.described(self.now, 0)["reason"]


def test_a_free_channel_that_is_used_is_used_more_until_the_ceiling():
    """From a quarter of it, in seconds; fixed limits have no part in it."""
    channel = Channel()
    assert channel.factor == TUNING.initial
    assert channel.run(20.0).factor == 1.0
    assert channel.why == "free"
    assert channel.capacity.report(channel.now) == (1.0,)


def test_what_is_not_used_does_not_grow():
    """Nobody knows whether the channel bore more."""
    channel = Channel()
    channel.use = 0.3
    assert channel.run(20.0).factor == TUNING.initial
    assert channel.why == "not used"


def test_a_growing_queue_decreases_the_limit_at_once_and_not_again_while_it_drains():
    """And the others hear of it at once."""
    channel = Channel().run(20.0)
    channel.capacity.reported(Digest("us", "us", channel.now, 0, 0, capacity=(1.0,)))
    assert not channel.capacity.has_news(channel.now)
    for wait in (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35):
        channel.waits["op"] = wait
        channel.run(0.1)
    assert channel.why in ("delay", "settling")
    assert 0.2 <= channel.factor <= 0.7
    assert channel.capacity.has_news(channel.now)
    assert math.isfinite(channel.capacity.wakes_at(channel.now))
    low = channel.run(0.3).factor
    channel.waits["op"] = 0.0
    assert channel.run(1.0).factor > low


@pytest.mark.parametrize("silent", ["they", "we"])
def test_silence_is_no_good_news(silent):
    """Nothing arrives from anybody, or nobody says that ours arrives: down to the floor, and fast up again after."""
    channel = Channel().run(20.0)
    if silent == "they":
        channel.waits["op"] = None
    else:
        channel.hears_us = False
    assert channel.run(3.0).factor >= 0.7
    assert channel.run(20.0).factor == pytest.approx(0.05)
    assert channel.why == "silence"
    channel.waits["op"], channel.hears_us = 0.0, True
    assert channel.run(10.0).factor > 0.5


def test_what_is_overdue_is_waited_for():
    """It may stand in a queue: little is sent until it comes."""
    channel = Channel().run(20.0)
    channel.waits["op"] = None
    assert channel.run(1.0).factor <= 0.4
    assert channel.why == "overdue"
    channel.waits["op"] = 0.0
    assert channel.run(2.0).factor == 1.0


def test_one_robot_that_is_far_away_decreases_nothing():
    """Neither what we see of it, nor what it tells, nor its leaving."""
    channel = Channel(peers=("a", "b", "far"), receivers=("a", "b", "far")).run(20.0)
    channel.waits["far"] = 0.8
    channel.tells["far"] = 0.05
    assert channel.run(10.0).factor == 1.0
    channel.waits["far"] = None
    assert channel.run(10.0).factor == 1.0
    channel.capacity.forget("far")
    assert channel.run(10.0).factor == 1.0


def test_what_two_robots_tell_is_in_force():
    """Or the only one that our samples go to; ours does not fall below the floor by it, nor decreases itself."""
    channel = Channel(peers=("op", "a", "b"), receivers=("op",)).run(20.0)
    channel.tells |= {"a": 0.3, "b": 0.2}
    assert channel.run(0.2).factor == pytest.approx(0.3)
    channel.tells |= {"a": 1.0, "b": 1.0, "op": 0.001}
    assert channel.run(0.2).factor == pytest.approx(0.05)
    assert channel.capacity.report(channel.now) == (1.0,)
    channel.tells["op"] = 1.0
    assert channel.run(0.2).factor == 1.0


def test_our_own_links_tell_as_well():
    """Of robots that we know."""
    channel = Channel().run(20.0)
    for i in range(8):
        channel.capacity.evidence.link_gauged(channel.now + 0.05, "op", 0.05 * i)
        channel.capacity.evidence.link_gauged(channel.now + 0.05, "stranger", 9.0)
        channel.run(0.1)
    assert channel.factor < 0.8


def test_random_loss_is_no_full_channel():
    """A constant loss does nothing. One that begins is tried out, and what was decreased for it is given back."""
    channel = Channel()
    channel.arriving = 0.95
    assert channel.run(30.0).factor == 1.0
    before = channel.sent
    channel.arriving = 0.95 * before / channel.sent
    received = 0.95 * before
    lowest = 1.0
    for _ in range(200):
        channel.run(0.1)
        received += 0.4 * (channel.sent - before)
        before, channel.arriving = channel.sent, received / channel.sent
        lowest = min(lowest, channel.factor)
    assert 0.3 < lowest < 0.8
    assert channel.run(10.0).factor > 0.95


def test_loss_by_load_decreases():
    """A channel that drops what it cannot carry, without any queue: less is sent, and less is lost."""
    channel = Channel()
    received = before = 0.0
    factors = []
    for i in range(600):
        channel.run(0.1)
        carried = min(channel.sent - before, 0.1 * RATE * (1.0 if i < 300 else 0.4))
        received, before = received + carried, channel.sent
        channel.arriving = received / channel.sent
        factors.append(channel.factor)
    assert factors[299] == 1.0
    assert max(factors[400:]) < 0.85


def test_without_anybody_nothing_is_known():
    """What was in force stays, and limits that stay keep their estimates under new specs."""
    channel = Channel(peers=())
    assert channel.run(10.0).factor == TUNING.initial
    assert channel.why == "nobody is there"
    channel.waits, channel.tells = {"op": 0.0}, {"op": 1.0}
    channel.run(20.0)
    channel.capacity.set_limits(channel.now, (AIR,))
    assert channel.factor == 1.0
    channel.capacity.set_limits(channel.now, (FIXED,))
    assert channel.capacity.factors == ()
    assert channel.capacity.due_at == math.inf
    channel.capacity.digest_received(channel.now, Digest("x", "x", 0.0, 0, 0))
    assert not channel.capacity.has_news(channel.now)


def test_who_uses_the_channel_speaks_often():
    """The time that digests take is what tells of it; who drops samples does not wait to hear that much is used."""
    channel = Channel().run(5.0)
    assert not channel.capacity.probe_due(channel.now)
    assert channel.capacity.probe_due(channel.now + 0.3)
    channel.use = 0.1
    assert channel.run(5.0).capacity.probe_due(channel.now + 0.3)
    channel.drops = False
    assert not channel.run(5.0).capacity.probe_due(channel.now + 0.3)


def test_who_knows_of_nothing_against_more_does_not_object():
    """Where estimates begin is no evidence; what a robot has seen is."""
    channel = Channel()
    channel.use = 0.3
    assert channel.run(5.0).factor == TUNING.initial
    assert channel.capacity.report(channel.now) == (1.0,)
    queue_of(channel, *(0.1 * i for i in range(1, 10)))
    assert channel.capacity.report(channel.now) == (channel.factor,)
    assert channel.factor < TUNING.initial


def test_who_follows_a_leader_takes_its_word_for_the_limit():
    """Up and down; others are not asked, and who has nothing against it tells no number of its own."""
    channel = Channel(peers=("op", "a", "b"))
    channel.leader, channel.use, channel.tells_use = "op", 0.1, (0.05,)
    channel.tells |= {"op": 0.2, "a": 0.1, "b": 0.1}
    assert channel.run(10.0).factor == pytest.approx(0.2)
    assert channel.capacity.report(channel.now) == (1.0,)
    channel.tells["op"] = 0.6
    assert channel.run(0.2).factor == pytest.approx(0.6)
    assert channel.why in ("free", "not used")


def test_a_leader_that_says_nothing_is_bad_news_like_anybody():
    """It may be that nothing gets through."""
    channel = Channel().run(20.0)
    channel.leader = "op"
    channel.run(1.0).waits["op"] = None
    assert channel.run(30.0).factor < 0.5
    assert channel.why == "silence"


def test_who_leads_tells_what_is_in_force_and_how_much_is_used():
    """What two others have against more decreases it once: then it grows as ever."""
    channel = Channel(peers=("a", "b"), receivers=())
    channel.leader = "us"
    channel.run(20.0).tells |= {"a": 0.4, "b": 0.4}
    force, used = channel.run(3.0).capacity.report(channel.now)
    assert force == channel.factor == pytest.approx(0.4)
    assert used == pytest.approx(0.4, rel=0.1)
    channel.tells |= {"a": 1.0, "b": 1.0}
    assert channel.run(1.0).factor == pytest.approx(0.4, rel=0.1)
    channel.tells["a"] = 0.2
    assert channel.run(20.0).factor == 1.0


def queue_of(channel, *waits, peers=("op",)):
    """Let a queue grow in front of these peers, to as much as the last of these."""
    for wait in waits:
        channel.waits |= dict.fromkeys(peers, wait)
        channel.run(0.1)
    return channel


def test_who_leads_tells_apart_what_passes():
    """While a queue drains less is in force; the others hear of both at once, and the lasting part stays."""
    channel = Channel(peers=("a", "b"), receivers=())
    channel.leader = "us"
    queue_of(channel.run(20.0), *(0.1 * i for i in range(1, 7)), peers=("a", "b"))
    lasting, _, draining = channel.capacity.report(channel.now)
    assert draining == channel.factor < 0.7 * lasting
    assert (lasting,) == tuple(limit.lasting for limit in channel.capacity._limits)
    assert channel.capacity.has_news(channel.now)
    assert channel.capacity.staleness(channel.now) > 0.3
    queue_of(channel, *[0.0] * 30, peers=("a", "b"))
    assert len(channel.capacity.report(channel.now)) == 2
    assert channel.factor >= lasting
    assert channel.capacity.staleness(channel.now) == 0.0


def test_who_follows_drains_with_its_leader():
    """For as long as it says so, and until its turn."""
    channel = Channel(peers=("op", "a"))
    channel.leader, channel.tells_use = "op", (0.5, 0.2)
    channel.tells["op"] = 0.6
    assert channel.run(5.0).factor == pytest.approx(0.2)
    assert tuple(limit.lasting for limit in channel.capacity._limits) == pytest.approx((0.6,))
    channel.tells_use = (0.5,)
    assert channel.run(0.5).factor == pytest.approx(0.6)


def test_who_sees_a_queue_that_its_leader_does_not_objects():
    """Until it has nothing against more any more; the leader it is who decreases the limit for all."""
    channel = Channel(peers=("op", "a", "b"))
    channel.leader, channel.tells_use = "op", (0.9,)
    channel.tells["op"] = 0.8
    queue_of(channel.run(10.0), *(0.1 * i for i in range(1, 9)))
    (told,) = channel.capacity.report(channel.now)
    assert told < 0.75
    assert channel.capacity.has_news(channel.now)
    queue_of(channel, *[0.0] * 100)
    assert channel.capacity.report(channel.now) == (1.0,)
    assert channel.factor == pytest.approx(0.8)


def test_who_leads_drains_a_queue_that_others_noticed_first():
    """Beside what they object to: at what the channel bears a queue stands for as long as it is full."""
    channel = Channel(peers=("a", "b"), receivers=())
    channel.leader = "us"
    queue_of(channel.run(20.0), *[0.045] * 10, peers=("a", "b"))
    assert channel.factor == 1.0
    channel.tells |= {"a": 0.5, "b": 0.5}
    queue_of(channel, 0.3, peers=("a", "b"))
    lasting, _, draining = channel.capacity.report(channel.now)
    assert lasting <= 0.5
    assert draining == channel.factor < 0.95 * lasting


@pytest.mark.parametrize(("peers", "later"), [(("a", "b"), True), (("x", "y"), False)])
def test_robots_begin_anew_one_after_the_other(peers, later):
    """By their names, within a window."""
    channel = Channel(peers=peers, receivers=())
    channel.leader, channel.tells_use = peers[0], (0.5, 0.2)
    channel.run(10.0).tells_use = (0.5,)
    assert (channel.run(0.2).factor < 0.5) is later
    assert channel.run(0.5).factor == pytest.approx(1.0)


def test_a_leader_is_followed_while_it_speaks():
    """Silence counts; and what the others tell when it has said nothing for long."""
    channel = Channel(peers=("op", "a", "b"))
    channel.leader, channel.tells_use = "op", (0.5,)
    channel.tells["op"] = 0.3
    assert channel.run(3.0).factor == pytest.approx(0.3)
    channel.waits["op"] = None
    assert channel.run(10.0).factor > 0.35
