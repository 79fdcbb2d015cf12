"""What a robot tells the others, and when."""

import math

from proxy.core import events as ev
from proxy.core.commands import SendDigest, SendState
from proxy.core.telling import RESTATE, STATE_PACE
from studies.simulation.conditions import Conditions
from studies.simulation.flights import fly
from studies.simulation.missions import draw, scenario


def test_states_follow_each_other_slowly(make_talk):
    """Whatever happens meanwhile is told by the next one."""
    talk = make_talk()
    talk.want(0.0)
    for step in range(50):
        talk.tell(ev.InterestChanged(1.0 + 0.01 * step, (f"k{step}",)))
    talk.tell(ev.TimePassed(60.0))
    states = talk.all(SendState)
    assert len(states) <= 3 + 0.5 / STATE_PACE
    assert states[-1].state.subscriptions == ("k49",)
    assert talk.core.telling.state == states[-1].state


def test_what_is_due_next_is_known(make_talk):
    """A state that may be news, at once or soon; digests wait while a plan is being made."""
    talk = make_talk()
    talk.want(0.0)
    talk.tell(ev.TimePassed(10.0))
    telling = talk.core.telling
    assert telling.next_at(10.0, digests=False) > 10.0
    telling.restate(10.0, soon=False)
    assert telling.next_at(10.0, digests=False) <= 10.0 + RESTATE
    telling.restate(10.0)
    assert telling.next_at(10.0, digests=True) <= 10.0 + STATE_PACE


def test_where_all_plan_for_all_every_send_is_told(make_talk):
    """Soon, if the allowance permits; a robot that nobody hears of tells nobody in particular."""
    talk = make_talk(allowance=0.02)
    talk.want(0.0)
    talk.tell(ev.TimePassed(5.0))
    before = len(talk.all(SendDigest))
    talk.tell(ev.SamplesPassed(5.1, "passed:no-spec", 1, 100))
    talk.tell(ev.TimePassed(8.0))
    told = talk.all(SendDigest)[before:]
    assert told
    assert {command.to for command in told} == {""}
    assert told[-1].digest.messages == 1
    assert talk.core.telling.speaks_again() < math.inf


def test_what_is_told_twice_is_no_old_digest():
    """Where much gets lost grants are told again, a little later: nothing that comes is refused."""
    how = Conditions(limit=2, seconds=10.0, loss=0.1)
    mission = draw(scenario("mixed"), 0, how)
    cores = fly(mission, how, 0).cores.values()
    assert any(core.layout.lent for core in cores)
    assert sum(core.refused.total() for core in cores) == 0
