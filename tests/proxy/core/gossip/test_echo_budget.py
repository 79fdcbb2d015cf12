"""Whose digests are echoed."""

from proxy.core.gossip.digest_budget import DigestBudget
from proxy.core.gossip.tuning import TUNING
from proxy.core.protocol.messages import Echo


def budget_of(rate, robots=1):
    made = DigestBudget(0.0)
    made.set_rate(rate, robots, robots)
    return made


def echo(peer):
    return Echo(peer, 0.0, 0.0, 0, 0.0)


def echoed(budget, now, echoes, copies):
    """What is echoed now of all that could be."""
    budget.advance(now)
    return budget.echoes.take(now, echoes, copies)


def test_each_peer_is_echoed_about_once_a_second():
    """If the allowance is large."""
    budget = budget_of(1e6)
    assert [e.peer for e in echoed(budget, 1.0, [echo("a"), echo("b")], 2)] == ["a", "b"]
    assert echoed(budget, 1.9, [echo("a")], 2) == ()
    assert {e.peer for e in echoed(budget, 2.0, [echo("a"), echo("b")], 2)} == {"a", "b"}


def test_of_many_peers_a_few_are_echoed_in_turn():
    """As many as a digest holds, and as a quarter of the allowance pays for."""
    peers = [echo(f"p{number:02}") for number in range(40)]
    budget = budget_of(1e6)
    told = [e.peer for now in (1.0, 1.1, 1.2, 1.3, 1.4) for e in echoed(budget, now, peers, 40)]
    assert told == [e.peer for e in peers]
    assert len(told) == 5 * TUNING.echoed
    poor = budget_of(100.0)
    told = [e.peer for now in range(1, 101) for e in echoed(poor, float(now), peers[:4], 4)]
    assert 100.0 * 100.0 / 4.0 * 0.8 <= len(told) * 23 * 4 - TUNING.echoes_ahead <= 100.0 * 100.0 / 4.0 * 1.1
    assert all(abs(told.count(e.peer) - len(told) / 4) <= 1 for e in peers[:4])
    broadcast = budget_of(100.0)
    assert len([e for now in range(1, 101) for e in echoed(broadcast, float(now), peers[:4], 1)]) > 3 * len(told)


def test_a_robot_that_begins_has_room_for_a_few_echoes():
    """Before it knows how many there are, too: without any nobody knows how long the way is."""
    budget = DigestBudget(0.0)
    budget.advance(0.1)
    budget.set_rate(1_000.0, 11, 11)
    budget.advance(0.2)
    assert budget.echoes.affords(10) == 2
