"""As leader, what others should send is planned, and lent to them ahead of time."""

from collections import Counter

import pytest

from proxy.core.commands import SendDigest
from proxy.core.core import Core
from proxy.core.events import TimePassed
from proxy.core.gate import PLAY
from studies.simulation.conditions import WARM_UP, Conditions
from studies.simulation.flights import fly, team
from studies.simulation.missions import draw, scenario
from studies.simulation.usage import usage


def flown(**conditions):
    how = Conditions(limit=2, seconds=10.0, loss=0.05, **conditions)
    return how, fly(mission_of(how), how, 0)


def mission_of(how):
    return draw(scenario("mixed"), 0, how)


def test_a_team_that_shares_uses_most_of_a_small_limit_and_never_exceeds_it():
    """Two messages per 2.5 s among ten robots: whole messages are lent to those who are planned to send."""
    how, flight = flown()
    told = usage(mission_of(how), flight, how)
    assert told.exceeding == 0.0
    assert told.messages >= 0.5
    leaders = [core for core in flight.cores.values() if core.shares.leads]
    assert len(leaders) == 1
    assert leaders[0].layout.lent > 5
    assert leaders[0].layout.due_at > 1000.0
    followers = [core.gate.decisions for core in flight.cores.values() if not core.shares.leads]
    assert sum(decisions.foreseen for decisions in followers) > sum(decisions.made for decisions in followers)


def test_in_a_team_without_a_channel_nobody_plans(make_talk):
    """A robot alone holds everything itself."""
    talk = make_talk(settle=0.0)
    talk.publish(0.1)
    assert not talk.core.layout.pending
    assert not [command for command in talk.said if isinstance(command, SendDigest) and command.to]


def test_who_may_not_lend_yet_is_not_woken_without_end(monkeypatch):
    """Until others follow, or what is told of a plan can be paid for, time alone is no reason to look at once again."""
    handle, woken = Core.handle, Counter()

    def counted(core, event):
        woken[core] += isinstance(event, TimePassed)
        return handle(core, event)

    monkeypatch.setattr(Core, "handle", counted)
    how = Conditions(limit=2, seconds=1.0, robots=3, coordination="shares", transport="broadcast")
    fly(mission_of(how), how, 0)
    assert max(woken.values()) < 100 * (WARM_UP + how.seconds)


def test_where_clocks_are_known_badly_slots_are_lent():
    """At a latency of 1 s a grant for one message would be lost in what clocks may be wrong by."""
    how, flight = flown(latency=1.0)
    told = usage(mission_of(how), flight, how)
    assert told.exceeding == 0.0
    assert told.messages >= 0.4
    assert [core.gate.standing for core in flight.cores.values() if core.shares.leads] == [True]
    assert any(lent.stays for core in flight.cores.values() for lent in core.shares._lent)
    followers = [core.gate.decisions for core in flight.cores.values() if not core.shares.leads]
    assert sum(decisions.foreseen for decisions in followers) > sum(decisions.made for decisions in followers)


def test_where_wall_clocks_are_known_to_be_right_single_messages_are_lent():
    """At a latency of 1 s, too; plans leave room for what clocks may be wrong by, and the limit is kept."""
    how, flight = flown(latency=1.0, clock_error=0.02)
    assert usage(mission_of(how), flight, how).exceeding == 0.0
    (leader,) = (core for core in flight.cores.values() if core.shares.leads)
    assert not leader.gate.standing
    now = leader.view.told_at("r1", 0.0)
    assert 0.04 < leader.gate._play(now) - PLAY < 0.1
    _, near = flown(clock_error=0.02)
    assert {core.gate._play(now) for core in near.cores.values()} == {PLAY}


@pytest.mark.parametrize(("latency", "slots"), [(0.02, False), (1.0, True)])
def test_irregular_streams_have_slots_where_ways_are_long_not_where_queues_are(latency, slots):
    """A queue drains; slots that come and go with it would make the next one."""
    how = Conditions(coordination="overhear", transport="broadcast", latency=latency, seconds=10.0)
    mission = draw(scenario("few"), 0, how)
    flight = fly(mission, how, 0)
    leader = next(core for core in flight.cores.values() if core.shares.leads)
    leader.gate._lateness.late = True
    assert leader.layout._irregular(leader.view.told_at("r1", 0.0)) is slots


def test_who_plans_slowly_lends_slots():
    """What it says of single messages would come too late."""
    how = Conditions(limit=2, seconds=4.0)
    flight = team(mission_of(how), how, 0)
    flight.decision_time = 0.4
    flight.run(mission_of(how).frames, WARM_UP + how.seconds)
    (leader,) = (core for core in flight.cores.values() if core.shares.leads)
    assert any(lent.stays for lent in leader.shares._lent)
    assert usage(mission_of(how), flight, how).exceeding == 0.0
