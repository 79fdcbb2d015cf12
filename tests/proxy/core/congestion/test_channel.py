"""The limits in force: those of the specs, and what the channel bears of adaptive ones."""

import math

import pytest

from proxy.core.interface import events as ev
from proxy.core.interface.commands import SetPace
from proxy.core.model.limits import limits_of
from proxy.core.protocol.messages import Digest
from tests.proxy.core.congestion.channels import AIR, BEGIN, FIXED, Channel, queue_of
from tests.proxy.core.talk import SPEC

ADAPTIVE = SPEC.replace('limit = "{limit}"', 'limit = "adaptive"\nceiling = "{limit}"').format(
    limit="800 kbit/s", window=1.0
)


def test_fixed_limits_are_in_force_as_they_are(make_talk, make_specs):
    """Nothing is told to the driver, and all of the allowance may be used."""
    talk = make_talk(make_specs(limit="80 kbit/s"))
    talk.want(0.0)
    channel = talk.core.channel
    assert not channel.look(1.0, 0)
    assert channel.apply() is None
    assert channel.allowance_factor == 1.0
    assert talk.core.budget.limits == limits_of(talk.core.view.specs, 0.0, 2)


def test_an_adaptive_limit_begins_with_a_part_of_its_ceiling(make_talk, make_specs):
    """In budget, pace and allowance alike."""
    talk = make_talk(make_specs(text=ADAPTIVE))
    talk.want(0.0)
    (factor,) = talk.core.channel.capacity.factors
    (limit,) = talk.core.budget.limits
    assert 0.0 < factor < 1.0
    (ceiling,) = limits_of(talk.core.view.specs, 0.0, 2)
    assert limit.limit == pytest.approx(factor * ceiling.limit)
    assert talk.core.channel.allowance_factor == pytest.approx(factor)
    assert talk.all(SetPace)[-1].rate == pytest.approx(factor * 100_000.0)


def test_a_limit_that_is_fixed_again_ends_the_pace(make_talk, make_specs):
    """The driver is told that there is none any more."""
    talk = make_talk(make_specs(text=ADAPTIVE))
    talk.want(0.0)
    talk.tell(ev.SpecsChanged(1.0, make_specs(limit="80 kbit/s")))
    assert talk.all(SetPace)[-1].rate == math.inf


def test_what_is_not_looked_at_any_more_is_not_late_for_ever(make_talk, make_specs):
    """Where limits stop being adaptive, nobody finds that a queue has drained."""
    talk = make_talk(make_specs(text=ADAPTIVE))
    talk.want(0.0)
    talk.core.channel.staleness = 0.5
    talk.tell(ev.SpecsChanged(1.0, make_specs(limit="80 kbit/s")))
    assert talk.core.channel.staleness == 0.0


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


def test_without_anybody_nothing_is_known():
    """What was in force stays, and limits that stay keep their estimates under new specs."""
    channel = Channel(peers=())
    assert channel.run(10.0).factor == BEGIN
    assert channel.why == "nobody is there"
    channel.waits, channel.tells = {"op": 0.0}, {"op": 1.0}
    channel.run(20.0)
    channel.capacity.set_limits(channel.now, (AIR,))
    assert channel.factor == 1.0
    channel.capacity.set_limits(channel.now, (FIXED,))
    assert channel.capacity.factors == ()
    assert channel.capacity.due_at == math.inf
    channel.capacity.digest_received(channel.now, Digest("x", "x", 0.0, 0, 0), channel.now)
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
    assert channel.run(5.0).factor == BEGIN
    assert channel.capacity.report(channel.now) == (1.0,)
    queue_of(channel, *(0.1 * i for i in range(1, 10)))
    assert channel.capacity.report(channel.now) == (channel.factor,)
    assert channel.factor < BEGIN


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


def test_who_leads_tells_apart_what_passes():
    """While a queue drains less is in force; the others hear of what lasts at once."""
    channel = Channel(peers=("a", "b"), receivers=())
    channel.leader = "us"
    queue_of(channel.run(20.0), *(0.1 * i for i in range(1, 7)), peers=("a", "b"))
    lasting, _ = channel.capacity.report(channel.now)
    assert channel.factor < 0.7 * lasting
    assert (lasting,) == tuple(limit.lasting for limit in channel.capacity._limits)
    assert channel.capacity.has_news(channel.now)
    assert channel.capacity.staleness(channel.now) > 0.3
    queue_of(channel, *[0.0] * 30, peers=("a", "b"))
    assert channel.factor >= lasting
    assert channel.capacity.staleness(channel.now) == 0.0


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
    lasting, _ = channel.capacity.report(channel.now)
    assert lasting <= 0.5
    assert channel.factor < 0.95 * lasting


def test_a_floor_that_the_channel_does_not_carry_is_told():
    """While a queue stands that nothing can be done about; a queue is no reason where less can be sent."""
    channel = Channel()
    queue_of(channel.run(10.0), *(0.1 * i for i in range(1, 26)))
    assert channel.capacity.warnings() == []
    queue_of(channel, *(2.5 + 0.1 * i for i in range(1, 101)))
    assert channel.factor == AIR.least
    assert channel.capacity.warnings() == [
        'constraint "air": the channel does not carry its floor, what is sent waits for 12 s: set a lower one'
    ]
    assert queue_of(channel, *[0.0] * 30).capacity.warnings() == []


def test_a_leader_is_followed_while_it_speaks():
    """Silence counts; and what the others tell when it has said nothing for long."""
    channel = Channel(peers=("op", "a", "b"))
    channel.leader, channel.tells_use = "op", (0.5,)
    channel.tells["op"] = 0.3
    assert channel.run(3.0).factor == pytest.approx(0.3)
    channel.waits["op"] = None
    assert channel.run(10.0).factor > 0.35
