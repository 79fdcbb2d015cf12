"""The gate where more than the most recent sample counts, and what it tells of its decisions, as transcripts."""

import pytest
from hypothesis import HealthCheck, given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from planner import Plan
from proxy.core.coordination.claims import news_take
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward
from proxy.core.model.mode import Mode
from proxy.core.model.transport import broadcast
from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState, tag
from proxy.core.view.stream import Generated
from proxy.core.view.view import GREETING
from tests.proxy.core.talk import SPEC, only

AGGREGATIONS = ["most_recent", "best", "sum", "once"]
STEPS = [*["publish"] * 6, *["delete"] * 2, *["answer"] * 3, "hand", "refuse", "mode", "join"]


@pytest.fixture
def make_aggregated(make_talk, make_specs):
    """A core whose camera samples combine as told, with robot op that wants them."""

    def make(aggregation, limit="80 kbit/s", **settings):
        text = SPEC.format(limit=limit, window=1.0).replace('"most_recent"', f'"{aggregation}"')
        talk = make_talk(make_specs(text=text), **settings)
        talk.want(0.0)
        return talk

    return make


def decide_all(talk, now, commands, *, send):
    """Answer every decision that comes up; return what was forwarded and dropped."""
    outcomes = only(commands, Forward, Drop)
    while decisions := only(commands, Decide):
        commands = talk.answer(now, decisions[0], send=send)
        outcomes += only(commands, Forward, Drop)
    return outcomes


@pytest.mark.parametrize("aggregation", ["best", "sum"])
def test_every_sample_waits_and_is_decided_with_those_behind_it(make_aggregated, aggregation):
    """Two more arrive during a decision: nothing is superseded, and the next window holds both."""
    talk = make_aggregated(aggregation)
    first, commands = talk.publish(0.1)
    second, _ = talk.publish(0.2, red=0.5)
    third, nothing = talk.publish(0.3)
    assert only(nothing) == []
    forward, decide = only(talk.answer(0.31, only(commands)[0], send=True))
    assert forward == Forward(first)
    opened = [(m.t_gen, m.scale) for m in decide.problem.messages if not m.sent and m.t_gen <= 0.3]
    assert opened == [(0.2, 6.0), (0.3, 1.0)]
    assert decide_all(talk, 0.32, [decide], send=True) == [Forward(second), Forward(third)]


def test_of_too_many_the_least_valuable_is_dropped(make_aggregated):
    """The bound is a setting; it counts where the limits have no room for all that wait."""
    talk = make_aggregated("sum", limit="24 kbit/s", backlog=2)
    talk.publish(0.1)
    talk.publish(0.2, red=0.5)
    least, _ = talk.publish(0.3, red=0.1)
    _, commands = talk.publish(0.4, red=0.2)
    assert only(commands) == [Drop(least, "dropped:overflow")]


@pytest.mark.parametrize(("coordination", "bounds"), [("announce", {"backlog": 2}), ("split", {"inbox_bytes": 4000})])
def test_while_the_limits_have_room_for_all_none_leaves_for_want_of_a_place(make_aggregated, coordination, bounds):
    """What is being decided and all that wait go at once, in order, without a search."""
    talk = make_aggregated("sum", coordination=coordination, settle=0.0, **bounds)
    talk.tell(ev.PeerGone(0.05, "op", "zz-op"))
    talk.tell(ev.MatchingChanged(0.05, "robot/r1/camera", matching=True))
    samples = [talk.publish(5.0 + 0.01 * n)[0] for n in range(9)]
    sent = [command.sample for command in talk.all(Forward)]
    assert len(sent) >= 5
    assert sent == samples[: len(sent)]
    assert not talk.all(Drop)


def test_deletions_keep_their_place_when_all_go_at_once(make_aggregated):
    """Before what was published after them."""
    talk = make_aggregated("sum", backlog=1, allowance=0.05)
    first, _ = talk.publish(0.1)
    second, _ = talk.publish(0.2)
    deletion, _ = talk.publish(0.3, delete=True)
    third, _ = talk.publish(0.4)
    talk.publish(0.5)
    talk.publish(0.6)
    assert [command.sample for command in talk.all(Forward)][:4] == [first, second, deletion, third]


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


def test_a_deletion_waits_for_all_samples_before_it_and_holds_those_after_it(make_aggregated):
    """Even one of higher priority that came later."""
    talk = make_aggregated("sum")
    first, commands = talk.publish(0.1)
    second, _ = talk.publish(0.2)
    delete, meanwhile = talk.publish(0.21, delete=True)
    later, _ = talk.publish(0.3, priority=1)
    assert only(meanwhile) == []
    assert decide_all(talk, 0.4, commands, send=True) == [
        Forward(first),
        Forward(second),
        Forward(delete),
        Forward(later),
    ]


def test_in_pass_the_order_around_a_deletion_is_kept(make_aggregated):
    """What is being decided is released first, what came after the deletion last."""
    talk = make_aggregated("sum")
    first, commands = talk.publish(0.1)
    second, _ = talk.publish(0.2)
    delete, _ = talk.publish(0.21, delete=True)
    later, _ = talk.publish(0.3, priority=1)
    released = [Forward(sample) for sample in (first, second, delete, later)]
    assert only(talk.tell(ev.ModeChanged(0.4, Mode.PASS))) == released
    assert only(talk.answer(0.5, only(commands)[0], send=True)) == []


@hypothesis_settings(deadline=None, max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    aggregation=st.sampled_from(AGGREGATIONS),
    coordination=st.sampled_from(["announce", "split"]),
    steps=st.lists(st.tuples(st.sampled_from(STEPS), st.integers(0, 5)), min_size=12, max_size=50),
)
def test_nothing_is_lost_and_deletions_keep_their_place(make_aggregated, aggregation, coordination, steps):
    """Whatever happens in whatever order: conservation at every step, and per key and priority first in, first out."""
    talk = make_aggregated(aggregation, coordination=coordination, backlog=2, settle=0.0, floor=0.0)
    talk.tell(ev.DigestHeard(0.05, Digest("op", "zz-op", 0.05, 0, 0)))
    now, decisions, approved, keys, deletes = 0.1, [], [], {}, set()
    for step, number in steps:
        now += 0.01
        if step in ("publish", "delete"):
            key, deleted = f"robot/{number % 2}/camera", step == "delete"
            sample, commands = talk.publish(now, key=key, red=number / 5, priority=3 + number // 2, delete=deleted)
            keys[sample] = key
            deletes |= {sample} if deleted else set()
        elif step == "answer" and decisions:
            commands = talk.answer(now, decisions.pop(), send=number % 2 == 0)
        elif step in ("hand", "refuse") and approved:
            talk.tell((ev.SampleHanded if step == "hand" else ev.SampleRefused)(now, approved.pop(0)))
            commands = []
        elif step == "mode":
            commands = talk.tell(ev.ModeChanged(now, [Mode.ENFORCE, Mode.SHADOW, Mode.PASS][number % 3]))
        elif step == "join":
            talk.tell(ev.StateHeard(now, State("op", "zz-op", "enforce", "", (), ("robot/*/camera",) * (number % 2))))
            commands = []
        else:
            continue
        decisions += only(commands, Decide)
        approved += [command.sample for command in only(commands, Forward)]
        assert talk.core.counts.conserved
    while decisions or talk.core.gate.undecided.inbox:
        now += 0.0 if decisions else 0.1  # some wait for room
        said = talk.answer(now, decisions.pop(), send=True) if decisions else talk.tell(ev.TimePassed(now))
        decisions += only(said, Decide)
    assert talk.core.gate.search.pending is None
    assert len(talk.core.gate.undecided.inbox) == 0
    sent = [command.sample for command in talk.all(Forward)]
    dropped = [command.sample for command in talk.all(Drop)]
    assert sorted(sent + dropped) == sorted(keys)
    assert deletes <= set(sent)
    for delete in deletes:
        before = sent[: sent.index(delete)]
        same = [sample for sample in sent if keys[sample] == keys[delete]]
        assert all((sample in before) == (sample < delete) for sample in same if sample != delete)


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
    talk.publish(5.2)
    assert talk.core.budget.used(5.2, 0) == 1000.0
    for robot, zid in (("r9", "z-r9"), ("op", "zz-op")):
        talk.tell(ev.StateHeard(5.3, State(robot, zid, "enforce", "", number=1)))
    talk.publish(5.4)
    assert [command.sample for command in talk.all(Forward)] == [1, 2]
    assert talk.core.budget.used(5.4, 0) == 1000.0


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


@hypothesis_settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=40)
@given(steps=st.lists(st.sampled_from(["sample", "unknown", "digest", "wait", "specs", "ask"]), max_size=25))
def test_what_others_sent_is_known_as_if_it_were_looked_for_each_time(make_talk, make_specs, steps):
    """However often it is asked for at one moment, whatever came in between, under whatever limits."""
    talk, now = make_talk(transport=broadcast("224.0.0.1:1")), 10.0
    budget, view = talk.core.budget, talk.core.view
    talk.tell(ev.PeerAppeared(now, "r2", "z-r2"))
    camera = (StreamState(1, "robot/r2/camera", "camera", 0.1),)
    talk.tell(
        ev.StateHeard(now, State("r2", "z-r2", "enforce", "", camera, ("**",), transport=view.settings.transport))
    )
    for count, step in enumerate(steps, start=1):
        size = 100 * count
        if step == "sample":
            talk.tell(ev.SampleHeard(now, "robot/r2/camera", size, "z-r2", None, None))
        elif step == "unknown":
            talk.tell(ev.SampleHeard(now, "other", size, "z-r2", None, None))
        elif step == "digest":
            news = StreamDigest(1, count, count, now, now, size, 1.0)
            talk.tell(ev.DigestHeard(now, Digest("r2", tag("z-r2"), now + 1e-4 * count, 0, 0, (news,))))
        elif step == "specs":
            talk.tell(ev.SpecsChanged(now, make_specs(limit=f"{count} kB/s", window=0.1 * count)))
        elif step == "wait":
            now += 0.3
        assert budget.others(now) == budget._sent_by_others(now)


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


@pytest.fixture
def rivals(make_talk, make_specs):
    """Two robots with cameras of 5 Hz that fill the limit twice; the other one's frame was due 5 ms ago."""
    talk = make_talk(make_specs())
    talk.want(0.0)
    talk.tell(ev.InterestChanged(0.0, ("robot/*/camera",)))
    talk.tell(ev.StateHeard(0.0, State("op", "zz-op", "enforce", "", OTHERS, ("robot/*/camera",), number=2)))
    other = talk.core.view.stream(0.0, "op", "robot/op/camera")
    for count in range(1, 41):
        decide_all(talk, 0.2 * count, talk.publish(0.2 * count, size=4000)[1], send=count == 38)
        other.note_generated(count, Generated(0.2 * count - 0.005, 4000, 1.0))
    return talk


OTHERS = (StreamState(1, "robot/op/camera", "camera", 0.2, size=4000, schedule="periodic"),)


def test_a_sample_gives_way_until_it_is_known_what_a_better_claim_had_sent(rivals):
    """The limit has room for one of the two: it goes when the other one was not sent."""
    sample, commands = rivals.publish(8.2, size=4000)
    assert only(rivals.answer(8.2, *only(commands, Decide), send=True)) == []
    again = rivals.tell(ev.TimePassed(8.2 + 1.1 * news_take(rivals.core.view)))
    assert only(rivals.answer(8.25, *only(again, Decide), send=True)) == [Forward(sample)]


def test_a_sample_that_gave_way_is_dropped_when_a_newer_one_is_there(rivals):
    """Which is decided in its place."""
    sample, commands = rivals.publish(8.2, size=4000)
    rivals.publish(8.203, size=4000)
    decided = rivals.answer(8.204, *only(commands, Decide), send=True)
    assert only(decided, Forward, Drop) == [Drop(sample, "dropped:constraint")]


def test_a_sample_does_not_give_way_where_there_is_room_for_both(rivals):
    """Nobody waits where all fits."""
    sample, commands = rivals.publish(8.2, size=100)
    assert only(rivals.answer(8.2, *only(commands, Decide), send=True)) == [Forward(sample)]


def test_in_the_end_a_sample_that_gives_way_is_dropped(rivals):
    """It is too old by then."""
    sample, commands = rivals.publish(8.2, t_gen=7.7, size=4000)
    assert only(rivals.answer(8.2, *only(commands, Decide), send=True)) == [Drop(sample, "dropped:constraint")]


@pytest.mark.parametrize("says", [True, False])
def test_a_large_sample_waits_for_what_somebody_who_was_just_met_sent_lately(make_talk, says):
    """Not for long, where it says nothing; what is small goes at once."""
    talk = make_talk()
    talk.want(0.0)
    talk.tell(ev.TimePassed(5.0))
    talk.tell(ev.PeerAppeared(5.0, "r2", "z-r2"))
    large, commands = talk.publish(5.1, size=3000)
    assert only(commands) == []
    assert talk.core.wake_at(5.1) <= 5.0 + GREETING
    small, commands = talk.publish(5.11, size=10, key="robot/x/camera")
    assert only(commands) == [Forward(small)]
    if says:
        commands = talk.tell(ev.StateHeard(5.13, State("r2", "z-r2", "enforce", "")))
    else:
        assert only(talk.tell(ev.TimePassed(4.99 + GREETING))) == []
        commands = talk.tell(ev.TimePassed(5.0 + GREETING))
    (decide,) = only(commands)
    assert isinstance(decide, Decide)
    assert only(talk.answer(5.3, decide, send=True)) == [Forward(large)]
