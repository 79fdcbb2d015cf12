"""What becomes of samples, and where that is counted, as transcripts."""

from planner import Plan
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward
from proxy.core.model.mode import Mode
from proxy.core.protocol.messages import State
from tests.proxy.core.samples.answers import decide_all
from tests.proxy.core.talk import only


def test_after_the_first_of_once_the_others_are_dropped_without_a_search(make_aggregated):
    """A robot that joins is worth another search; so is a first one that never left the robot."""
    talk = make_aggregated("once")
    first, commands = talk.publish(0.1)
    second, _ = talk.publish(0.2)
    outcomes = only(talk.answer(0.3, only(commands)[0], send=True))
    assert outcomes == [Forward(first), Drop(second, "dropped:once")]
    talk.tell(ev.SampleRefused(0.35, first))
    third, commands = talk.publish(0.4)
    assert decide_all(talk, 0.41, commands, send=True) == [Forward(third)]
    talk.tell(ev.SampleHanded(0.45, third))
    fourth, commands = talk.publish(0.5)
    assert only(commands) == [Drop(fourth, "dropped:once")]
    talk.want(0.6, "r3", "z-r3")
    _, commands = talk.publish(0.7)
    assert isinstance(only(commands)[0], Decide)


def test_in_shadow_what_once_makes_worthless_goes_all_the_same(make_aggregated):
    """And is counted as what would be dropped."""
    talk = make_aggregated("once", mode=Mode.SHADOW)
    _, commands = talk.publish(0.1)
    talk.answer(0.2, only(commands)[0], send=True)
    second, commands = talk.publish(0.3)
    assert only(commands) == [Forward(second)]
    assert talk.core.status(0.4)["decisions"]["would_drop"] == 1
    (stream,) = talk.core.status(0.4)["streams"]
    assert stream["by_reason"] == {"dropped:once": 1, "forwarded": 1}


def test_the_status_explains_the_last_decision_and_counts_what_bound(make_aggregated):
    """By the names that the problem gives its constraints."""
    talk = make_aggregated("most_recent", coordination="split", settle=0.0)
    talk.tell(ev.PeerGone(0.05, "op", "zz-op"))
    talk.tell(ev.MatchingChanged(0.05, "robot/r1/camera", matching=True))
    _, commands = talk.publish(5.1)
    plan = Plan(
        send=False,
        sends=(),
        utility=2.0,
        opposite=1.5,
        iterations=7,
        nodes=9,
        lead=0.25,
        gap=0.5,
        prices=(0.0, 1.0),
        binding=("throughput",),
        seconds=0.004,
    )
    talk.tell(ev.DecisionReady(5.2, only(commands)[0].ticket, plan))
    talk.tell(ev.SamplesPassed(5.25, "passed:no-spec", 1, 6000))
    talk.publish(5.3, size=6000)
    decisions = talk.core.status(6.2)["decisions"]
    last = decisions.pop("last")
    assert (last["age"], last["key"], last["reason"]) == (1.0, "robot/r1/camera", "dropped:planner")
    assert last["prices"] == {"throughput": 0.0}
    assert decisions == {
        "made": 1,
        "iterations": 7,
        "would_drop": 0,
        "unneeded": 0,
        "certain": 0,
        "undisputed": 0,
        "hopeless": 0,
        "owed": 0,
        "unkept": 0,
        "late": 0,
        "thinned": {"windows": 0, "messages": 0, "of": 0},
        "seconds": 0.004,
        "longest": 0.004,
        "proven": 0,
        "bounded": 1,
        "gap": 0.5,
        "utility": 2.0,
        "binding": {"throughput": 2},
    }


def test_constraints_that_leave_no_room_are_counted_by_name(make_aggregated):
    """Where all is overheard they are the union's."""
    talk = make_aggregated("most_recent")
    _, commands = talk.publish(0.1, size=6000)
    talk.answer(0.11, only(commands)[0], send=True)
    talk.publish(0.2, size=6000)
    assert talk.core.status(0.3)["decisions"]["binding"] == {"throughput": 1}


def test_until_all_said_what_they_want_what_nobody_wants_counts(make_talk):
    """It may be for who is new: it goes, and what is decided has to do with the rest."""
    talk = make_talk()
    talk.tell(ev.PeerAppeared(0.3, "r9", "z-r9"))
    talk.publish(0.6)
    assert talk.core.budget.used(0.6, 0) == 1000.0
    for robot, zid in (("r9", "z-r9"), ("op", "zz-op")):
        talk.tell(ev.StateHeard(0.7, State(robot, zid, "enforce", "", number=1)))
    talk.publish(0.8)
    assert [command.sample for command in talk.all(Forward)] == [1, 2]
    assert talk.core.budget.used(0.8, 0) == 1000.0


def test_what_never_came_to_a_decision_is_told_of_its_stream(make_talk, make_aggregated):
    """Newer ones took its place, here or before the core, or too many waited."""
    talk = make_talk()
    talk.want(0.0)
    for now in (0.1, 0.11, 0.12):
        talk.publish(now)
    talk.publish(0.2, superseded=3)
    (stream,) = talk.core.status(0.3)["streams"]
    assert (stream["generated"], stream["by_reason"]) == (7, {"dropped:superseded": 5})
    talk = make_aggregated("sum", limit="24 kbit/s", backlog=2)
    for now in (0.1, 0.11, 0.12, 0.13):
        talk.publish(now)
    (stream,) = talk.core.status(0.3)["streams"]
    assert stream["by_reason"] == {"dropped:overflow": 1}
    assert talk.core.counts.conserved
