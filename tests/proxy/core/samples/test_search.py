"""Searches that are late or take too long, as transcripts."""

import pytest

from planner import Plan
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward
from tests.proxy.core.talk import only


def test_what_is_not_decided_in_time_the_static_rule_decides_at_once(make_aggregated):
    """It is counted; the answer that comes later changes nothing, and the next sample has its own decision."""
    talk = make_aggregated("most_recent", deadline=0.02)
    first, commands = talk.publish(0.1)
    (late,) = only(commands, Decide)
    assert late.asked == 0.1
    assert only(talk.tell(ev.DecisionLate(0.12, late.ticket))) == [Forward(first)]
    talk.tell(ev.SampleHanded(0.13, first))
    assert only(talk.answer(0.2, late, send=False)) == []
    _, commands = talk.publish(0.3)
    (decide,) = only(commands, Decide)
    assert only(talk.tell(ev.DecisionLate(0.31, late.ticket))) == []
    assert only(talk.answer(0.31, decide, send=False), Drop)
    status = talk.core.status(0.4)
    assert status["counts"]["by_reason"] == {"dropped:planner": 1, "passed:fallback": 1}
    assert (status["decisions"]["late"], status["decisions"]["made"]) == (1, 1)
    assert status["counts"]["conserved"]


def test_what_is_late_is_sent_as_far_as_it_fits(make_aggregated):
    """Of 40 kB in 4 s almost all that the limit of 10 kB/s lets through goes, and never more in any window."""
    talk = make_aggregated("sum", deadline=0.02, allowance=0.05)
    for number in range(40):
        now = 0.1 * (1 + number)
        decides = only(talk.publish(now)[1], Decide)
        while decides:
            decides += only(talk.tell(ev.DecisionLate(now + 0.02, decides.pop().ticket)), Decide)
    assert 30 <= len(talk.all(Forward)) <= 40


@pytest.mark.parametrize("priority", [1, 6])
def test_what_is_late_leaves_room_for_more_urgent_samples_that_wait(make_aggregated, priority):
    """Only one of the two fits: the more urgent one is sent, else the one that was late."""
    talk = make_aggregated("sum", deadline=0.02)
    before, commands = talk.publish(0.1)
    talk.answer(0.11, *only(commands, Decide), send=True)
    first, commands = talk.publish(0.2, size=6000)
    (late,) = only(commands, Decide)
    second, _ = talk.publish(0.21, size=6000, priority=priority)
    commands = talk.tell(ev.DecisionLate(0.22, late.ticket))
    for decide in only(commands, Decide):
        talk.tell(ev.DecisionLate(0.24, decide.ticket))
    assert talk.all(Forward) == [Forward(before), Forward(second if priority == 1 else first)]


def slow_days(talk):
    """Publish more than is decided in time; return the windows, of how many messages each."""
    held = []
    for number in range(30):
        now = 0.1 * (1 + number)
        overhead = 0.05 if 10 <= number < 14 else 0.001
        _, commands = talk.publish(now)
        for decide in only(commands, Decide):
            held.append(sum(not m.sent for m in decide.problem.messages))
            plan = Plan(send=False, sends=(), utility=1.0, opposite=None, iterations=10, nodes=10)
            talk.tell(ev.DecisionReady(now + overhead, decide.ticket, plan, overhead=overhead))
    return held


def test_windows_that_took_too_long_to_decide_are_thinned_and_status_says_so(make_aggregated):
    """They are smaller while decisions come late, and whole again by and by; the same events give the same windows."""
    talk, again = (make_aggregated("sum", deadline=0.02) for _ in range(2))
    held = slow_days(talk)
    least = min(held[5:])
    assert least < 0.5 * held[9]
    assert held.index(least) > 10
    assert held[-1] > 2 * least
    thinned = talk.core.status(4.0)["decisions"]["thinned"]
    assert 4 <= thinned["windows"] < 30
    assert 0 < thinned["messages"] < thinned["of"]
    assert slow_days(again) == held
