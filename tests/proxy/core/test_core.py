"""The core as transcripts of events and commands."""

import math
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from proxy.core.gossip.tuning import TUNING as GOSSIP
from proxy.core.interface import events as ev
from proxy.core.interface.commands import (
    AskState,
    Decide,
    Drop,
    Forward,
    NoteInterest,
    Notice,
    Reread,
    SendDigest,
    SendState,
    SetPace,
)
from proxy.core.model.mode import Mode
from proxy.core.protocol.fixed import rounded, single
from proxy.core.protocol.messages import Digest, Echo, State, StreamDigest, StreamState
from proxy.core.view.tuning import TUNING as VIEW
from tests.proxy.core.streams import periodic, poisson
from tests.proxy.core.talk import ALL_KINDS, SPEC, UNLIMITED, only
from utility_specs.constraint_tables import FLOOR


def test_a_sample_is_decided_and_forwarded(make_talk):
    """Publish, decide, forward, hand over: counted once, as forwarded."""
    talk = make_talk()
    talk.want(0.0)
    sample, commands = talk.publish(0.1)
    (decide,) = only(commands)
    assert isinstance(decide, Decide)
    assert decide.iterations == 300
    assert only(talk.answer(0.11, decide, send=True)) == [Forward(sample)]
    assert talk.core.counts.queued == 1
    talk.tell(ev.SampleHanded(0.12, sample))
    assert talk.core.counts.by_reason == {"forwarded": 1}
    assert talk.core.counts.conserved


def test_what_is_heard_is_noted_and_brings_about_what_is_due(make_talk):
    """Nothing else: a sample of another robot changes nothing here by itself, but time passes with it, too."""
    talk = make_talk()
    talk.want(0.0)
    for now in (1.0, 2.0, 3.0):
        talk.tell(ev.TimePassed(now))
    due = talk.core.gossip.due_at(3.0)

    def heard(now):
        return talk.tell(ev.SampleHeard(now, "robot/op/map", 100, "op", None, None))

    assert heard(3.2) == []
    assert 3.2 < talk.core.wake_at(3.2) <= due
    assert [type(command) for command in heard(due)] == [SendDigest]
    assert talk.core.wake_at(due) > due


def test_the_features_of_a_sample_reach_the_planner_and_stay_with_what_was_sent(make_talk, make_specs):
    """A Python utility is tabulated for the sample to decide, and for the last one that was sent."""
    python = '{ kind = "python", function = "tests.utility_specs.worths:by_red" }'
    text = SPEC.format(limit="80 kbit/s", window=1.0).replace('{ kind = "video" }', python)
    talk = make_talk(make_specs(text=text))
    talk.want(0.0)
    _, commands = talk.publish(0.1, red=0.25)
    talk.answer(0.11, only(commands, Decide)[0], send=True)
    _, commands = talk.publish(0.2, red=0.75)
    problem = only(commands, Decide)[0].problem
    sent, current = problem.messages[0], problem.messages[problem.current]
    assert (sent.utility.features, current.utility.features) == ({"red": 0.25}, {"red": 0.75})


def test_a_sample_that_the_plan_drops_never_goes_out(make_talk):
    """The reason says who dropped it."""
    talk = make_talk()
    talk.want(0.0)
    sample, commands = talk.publish(0.1)
    assert only(talk.answer(0.11, only(commands)[0], send=False)) == [Drop(sample, "dropped:planner")]
    assert talk.core.counts.by_reason == {"dropped:planner": 1}


def test_while_one_is_decided_the_latest_of_a_stream_wins(make_talk):
    """Two more samples arrive during a decision: the older of them is superseded."""
    talk = make_talk()
    talk.want(0.0)
    _, commands = talk.publish(0.1)
    second, nothing = talk.publish(0.2)
    assert only(nothing) == []
    third, commands_of_third = talk.publish(0.3)
    assert only(commands_of_third) == [Drop(second, "dropped:superseded")]
    after = only(talk.answer(0.31, only(commands)[0], send=False))
    assert [type(command) for command in after] == [Drop, Decide]
    current = after[1].problem.messages[after[1].problem.current]
    assert current.t_gen == 0.3
    assert talk.core.gate.search.pending.sample.sample == third


def test_what_does_not_fit_is_dropped_without_a_search(make_talk):
    """A limit of 10 kB per second, less what digests may use, carries 9 samples of 1 kB."""
    talk = make_talk()
    talk.want(0.0)
    outcomes = []
    for i in range(12):
        _, commands = talk.publish(0.1 + 0.01 * i)
        decisions = only(commands, Decide)
        outcomes += only(talk.answer(0.105 + 0.01 * i, decisions[0], send=True) if decisions else commands)
    assert [type(outcome) for outcome in outcomes] == [Forward] * 9 + [Drop] * 3
    assert outcomes[-1].reason == "dropped:constraint"


@pytest.mark.parametrize("coordination", ["announce", "split"])
def test_the_limit_is_checked_again_when_the_answer_comes(make_talk, coordination):
    """What others sent during the search counts."""
    talk = make_talk(coordination=coordination, settle=0.0, floor=0.0)
    talk.tell(ev.MatchingChanged(0.0, "robot/r1/camera", matching=True))
    sample, commands = talk.publish(0.1, size=6000)
    talk.tell(ev.SamplesPassed(0.11, "passed:no-spec", 1, 6000))
    (decide,) = only(commands, Decide)[:1]
    assert only(talk.answer(0.12, decide, send=True), Drop) == [Drop(sample, "dropped:constraint")]


def test_in_shadow_everything_goes_and_the_decision_is_counted(make_talk):
    """A team starts by watching."""
    talk = make_talk(mode=Mode.SHADOW)
    talk.want(0.0)
    sample, commands = talk.publish(0.1)
    assert only(talk.answer(0.11, only(commands)[0], send=False)) == [Forward(sample)]
    talk.tell(ev.SampleHanded(0.12, sample))
    assert talk.core.counts.by_reason == {"passed:shadow": 1}
    decisions = talk.core.status(0.2)["decisions"]
    assert (decisions["made"], decisions["iterations"], decisions["would_drop"]) == (1, 10, 1)


def test_in_shadow_nothing_is_superseded(make_talk):
    """All go, in order, however slow the decisions are."""
    talk = make_talk(mode=Mode.SHADOW)
    talk.want(0.0)
    (first, commands), (second, _), (third, _) = (talk.publish(at) for at in (0.1, 0.11, 0.12))
    went = []
    for now in (0.13, 0.14, 0.15):
        (decide,) = only(commands, Decide)
        commands = talk.answer(now, decide, send=False)
        went += only(commands, Forward, Drop)
    assert went == [Forward(first), Forward(second), Forward(third)]


def test_samples_that_gave_way_before_the_core_are_counted_and_generated(make_talk):
    """The core learns of them with the one that took their place."""
    talk = make_talk()
    talk.want(0.0)
    talk.publish(0.1)
    talk.publish(0.4, superseded=2)
    (stream,) = talk.core.view.streams.own()
    assert (stream.generated, round(stream.schedule.period, 3)) == (4, 0.1)
    assert talk.core.counts.by_reason["dropped:superseded"] == 2
    assert talk.core.counts.conserved


def test_in_pass_nothing_is_decided(make_talk):
    """A plain bridge; switching to it releases what is being decided, and then what waits."""
    talk = make_talk()
    talk.want(0.0)
    first, commands = talk.publish(0.1)
    waiting, _ = talk.publish(0.2)
    assert only(talk.tell(ev.ModeChanged(0.21, Mode.PASS))) == [Forward(first), Forward(waiting)]
    assert only(talk.answer(0.25, only(commands)[0], send=False)) == []
    sample, commands = talk.publish(0.3)
    assert only(commands) == [Forward(sample)]
    assert talk.core.status(0.3)["mode"] == "pass"


@pytest.mark.parametrize(
    ("prepare", "publish", "reason"),
    [
        (None, {}, "passed:unwanted"),
        ("want", {"key": "other/key"}, "passed:no-spec"),
        ("want", {"delete": True}, "passed:delete"),
        ("want", {"origin": "zz-op"}, "passed:relayed"),
    ],
)
def test_what_needs_no_decision_passes_with_its_reason(make_talk, prepare, publish, reason):
    """Nobody wants it, no spec covers it, it deletes, or another robot already sent it."""
    talk = make_talk()
    if prepare:
        talk.want(0.0)
    sample, commands = talk.publish(0.1, **publish)
    assert only(commands) == [Forward(sample)]
    talk.tell(ev.SampleHanded(0.2, sample))
    assert talk.core.counts.by_reason == {reason: 1}


def test_a_delete_follows_what_was_published_before_it(make_talk):
    """It waits for the sample being decided, and supersedes the one that waits behind it."""
    talk = make_talk()
    talk.want(0.0)
    first, commands = talk.publish(0.1)
    second, _ = talk.publish(0.2)
    delete, meanwhile = talk.publish(0.21, delete=True)
    assert only(meanwhile) == [Drop(second, "dropped:superseded")]
    assert only(talk.answer(0.3, only(commands)[0], send=True)) == [Forward(first), Forward(delete)]
    later, alone = talk.publish(0.4, delete=True)
    assert only(alone) == [Forward(later)]
    assert talk.core.counts.conserved


def test_without_a_constraint_covered_samples_are_forwarded_at_once(make_talk, make_specs):
    """Nothing is scarce."""
    talk = make_talk(make_specs(text=UNLIMITED))
    talk.want(0.0)
    sample, commands = talk.publish(0.1)
    assert only(commands) == [Forward(sample)]


def test_a_failing_planner_falls_back_to_a_static_rule_loudly(make_talk):
    """Urgent samples may use what is free, others half of what is ours; never everything."""
    talk = make_talk()
    talk.want(0.0)
    outcomes = []
    for i, priority in enumerate([5, 5, 2, 2, 2]):
        _, commands = talk.publish(0.1 + 0.01 * i, size=3000, priority=priority)
        decide = only(commands, Decide)
        answer = talk.tell(ev.DecisionReady(0.105 + 0.01 * i, decide[0].ticket, None, "boom")) if decide else commands
        outcomes += only(answer, Forward, Drop)
    assert [type(outcome) for outcome in outcomes] == [Forward, Drop, Forward, Forward, Drop]
    error = next(notice for notice in talk.all(Notice) if notice.level == "error")
    assert "boom" in error.text
    assert error.fields["reason"] == "planner"  # of which few are logged, whatever each error says
    talk.tell(ev.SampleHanded(0.3, 1))
    assert talk.core.counts.by_reason["passed:fallback"] == 1


def test_a_sample_that_egress_refuses_is_counted_as_dropped(make_talk):
    """The law of conservation holds whatever the mesh session does."""
    talk = make_talk()
    sample, _ = talk.publish(0.1)
    talk.tell(ev.SampleRefused(0.2, sample))
    assert talk.core.counts.by_reason == {"dropped:egress": 1}
    assert talk.core.counts.conserved


def test_a_backlog_shrinks_the_budget_of_iterations(make_talk, make_specs):
    """A decision gets less time the more wait."""
    talk = make_talk(make_specs(limit="80 kbit/s"))
    talk.want(0.0)
    _, commands = talk.publish(0.1)
    for i in range(20):
        talk.publish(0.2 + 0.01 * i, key=f"robot/x{i}/camera")
    after = only(talk.answer(0.5, only(commands)[0], send=True), Decide)
    assert after[0].iterations == 300 // (1 + 19 // 4)


def test_an_answer_nobody_waits_for_changes_nothing(make_talk):
    """Tickets are matched."""
    talk = make_talk()
    assert only(talk.tell(ev.DecisionReady(0.1, 999, None, "late"))) == []


def test_a_digest_tells_of_every_sample_also_of_dropped_ones(make_talk):
    """Counts generated and forwarded, and the value of the last."""
    talk = make_talk()
    talk.want(0.0)
    for i, send in enumerate([True, False]):
        _, commands = talk.publish(1.0 + i, size=1000, red=0.2)
        talk.answer(1.01 + i, only(commands, Decide)[0], send=send)
    talk.tell(ev.TimePassed(4.0))
    streams = [stream for command in talk.all(SendDigest) for stream in command.digest.streams]
    assert streams[-1].generated == 2
    assert streams[-1].forwarded == 1
    assert streams[-1].scale == pytest.approx(3.0)
    assert streams[-1].t_generated == 2.0
    assert talk.all(SendDigest)[-1].digest.bytes == 1000


def test_a_digest_goes_out_at_least_every_second(make_talk):
    """The core asks to be woken for it."""
    talk = make_talk(allowance=0.02)
    talk.want(0.0)
    talk.tell(ev.TimePassed(2.5))
    before = len(talk.all(SendDigest))
    wake = talk.core.wake_at(2.5)
    assert 2.5 <= wake <= 3.5
    talk.tell(ev.TimePassed(3.6))
    assert len(talk.all(SendDigest)) == before + 1


def test_the_state_is_told_when_it_changes_and_only_then(make_talk):
    """A new stream, a subscription, a mode: yes. A period that moves by a percent: no."""
    talk = make_talk()
    talk.want(0.0)
    talk.tell(ev.TimePassed(1.0))
    told = len(talk.all(SendState))
    for i in range(20):
        talk.publish(2.0 + i * 0.5)
    assert len(talk.all(SendState)) <= told + 3
    told = len(talk.all(SendState))
    talk.publish(12.02)
    assert len(talk.all(SendState)) == told
    talk.tell(ev.InterestChanged(13.0, ("a/**",)))
    assert talk.all(SendState)[-1].state.subscriptions == ("a/**",)
    talk.tell(ev.ModeChanged(14.0, Mode.SHADOW))
    assert talk.all(SendState)[-1].state.mode == "shadow"


def test_new_specs_are_in_force_whole_at_the_next_decision(make_talk, make_specs):
    """Limits and types change together; streams that are no longer covered pass, what waited of them first."""
    talk = make_talk()
    talk.want(0.0)
    first, _ = talk.publish(0.1)
    other = UNLIMITED.replace("robot/*/camera", "other/*")
    talk.tell(ev.SpecsChanged(0.2, make_specs(text=other)))
    assert talk.core.budget.limits == ()
    sample, commands = talk.publish(0.3)
    assert only(commands) == [Forward(first), Forward(sample)]


def test_a_robot_that_leaves_is_out_of_the_plan(make_talk):
    """Its streams are forgotten, and it wants nothing any more."""
    talk = make_talk()
    talk.want(0.0)
    state = State("r2", "z-r2", "enforce", "", (StreamState(7, "robot/r2/camera", "camera", 0.5),))
    talk.tell(ev.PeerAppeared(0.0, "r2", "z-r2"))
    talk.tell(ev.StateHeard(0.0, state))
    talk.tell(ev.DigestHeard(0.1, Digest("r2", "z-r2", 0.1, 0, 0, (StreamDigest(7, 1, 1, 0.1, 0.1, 9, 1.0),))))
    assert len(list(talk.core.view.streams)) == 1
    talk.tell(ev.PeerGone(1.0, "r2", "z-r2"))
    talk.tell(ev.PeerGone(1.0, "op", "zz-op"))
    assert list(talk.core.view.streams) == []
    _, commands = talk.publish(1.1)
    assert isinstance(only(commands)[0], Forward)
    assert talk.tell(ev.PeerGone(1.2, "op", "zz-op")) == []


def test_malformed_talk_is_counted_and_changes_nothing(make_talk):
    """What is no digest is not taken in."""
    talk = make_talk()
    talk.tell(ev.MalformedHeard(0.1, "r2"))
    assert talk.core.status(0.1)["malformed"] == 1


def test_something_that_is_no_event_is_an_error(make_talk):
    """The driver's mistakes are loud."""
    with pytest.raises(TypeError, match="no event of the core"):
        make_talk().core.handle("hello")


def test_the_same_events_give_the_same_commands(make_talk):
    """Determinism: a recording replays to the last decision."""

    def transcript():
        talk = make_talk(coordination="split", settle=0.0, allowance=0.02)
        talk.want(0.0)
        for i in range(30):
            _, commands = talk.publish(0.1 * i + 1.0, red=0.1 * (i % 3))
            for decide in only(commands, Decide):
                talk.answer(0.1 * i + 1.01, decide, send=i % 2 == 0)
        return talk.said

    assert transcript() == transcript()


MOST = min(40, hypothesis_settings().max_examples)


@hypothesis_settings(deadline=None, max_examples=MOST, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.sampled_from(["announce", "split"]),
    st.lists(st.tuples(st.integers(1, 400), st.integers(1, 6000)), min_size=20, max_size=60),
)
def test_no_constraint_of_any_kind_is_ever_broken(make_talk, make_specs, coordination, published):
    """Whatever is published, and though every plan says send: each measure stays within its limit in every window."""
    specs = make_specs(text=ALL_KINDS)
    talk = make_talk(specs, coordination=coordination, settle=0.0, floor=0.0)
    talk.want(0.0)
    talk.tell(ev.DigestHeard(0.01, Digest("op", "zz-op", 0.01, 0, 0)))
    now, sizes, sent = 0.1, {}, []
    for gap, size in published:
        now += gap / 1000
        sample, commands = talk.publish(now, size=size)
        sizes[sample] = size
        for decide in only(commands, Decide):
            commands = talk.answer(now, decide, send=True)
        sent += [(now, sizes[command.sample]) for command in only(commands, Forward)]
    assert sent
    for measure in (spec.measure for spec in specs.constraints):
        for end, _ in sent:
            window = [measure.use(size, 1, own=True) for t, size in sent if end - measure.window <= t <= end]
            assert sum(window) <= measure.limit * (1.0 + 1e-9)


@pytest.mark.parametrize(
    ("size", "gap", "kind"), [(200, 0.01, "messages"), (1500, 0.2, "energy"), (4000, 0.2, "throughput")]
)
def test_the_tightest_constraint_decides(make_talk, make_specs, size, gap, kind):
    """Many small messages run into the count, the energy of a longer window, or the bytes, whichever is first."""
    talk = make_talk(make_specs(text=ALL_KINDS))
    talk.want(-10.0)
    sent = 0
    for i in range(40):
        now = 0.1 + gap * i
        _, commands = talk.publish(now, size=size)
        decisions = only(commands, Decide)
        if not decisions:
            break
        sent += len(only(talk.answer(now, decisions[0], send=True), Forward))
    left = {}
    for k, limit in enumerate(talk.core.budget.limits):
        use = limit.measure.use(size, 1, own=True)
        left[limit.measure.kind] = talk.core.budget.free(now)[k] / use
    assert sent >= 2
    assert min(left, key=left.get) == kind
    assert left[kind] < 1.0


def test_what_others_send_uses_none_of_our_energy(make_talk, make_specs):
    """Overheard messages count by every other measure."""
    talk = make_talk(make_specs(text=ALL_KINDS))
    talk.want(0.0)
    talk.tell(ev.PeerAppeared(0.0, "r2", "z-r2"))
    talk.tell(
        ev.StateHeard(0.0, State("r2", "z-r2", "enforce", "", (StreamState(7, "robot/r2/camera", "camera", 0.5),)))
    )
    news = StreamDigest(7, 1, 1, 0.1, 0.1, 4900, 1.0)
    talk.tell(ev.DigestHeard(0.1, Digest("r2", "z-r2", 0.1, 0, 0, (news,))))
    uses = {limit.measure.kind: limit.limit for limit in talk.core.budget.limits}
    room = [0.0, 0.0, 0.0, uses["energy"]]
    assert [limit.measure.kind for limit in talk.core.budget.limits] == ["throughput", "messages", "airtime", "energy"]
    assert not talk.core.budget.lacking(0.2, tuple(room))
    assert talk.core.budget.lacking(0.2, (uses["throughput"] - 4000.0, 0.0, 0.0, 0.0))
    assert talk.core.budget.lacking(0.2, (0.0, uses["messages"] - 0.5, 0.0, 0.0))


def test_messages_that_nobody_decides_on_are_counted_one_by_one(make_talk, make_specs):
    """Three samples of 900 B together are three messages of 300 B."""
    talk = make_talk(make_specs(text=ALL_KINDS), settle=0.0, floor=0.0)
    talk.tell(ev.SamplesPassed(0.1, "passed:no-spec", 3, 900))
    budget = {row["kind"]: row for row in talk.core.status(0.1)["budget"]}
    assert (budget["throughput"]["used"], budget["messages"]["used"]) == (900.0, 3.0)
    assert budget["energy"]["used"] == pytest.approx(3 * (2e-3 + 300e-6))


def test_the_status_tells_units_and_whose_a_budget_is(make_talk, make_specs):
    """Energy is each robot's own; of what robots share each has its part where they split."""
    talk = make_talk(make_specs(text=ALL_KINDS), coordination="split")
    talk.want(0.0)
    rows = talk.core.status(0.1)["budget"]
    assert [(row["kind"], row["unit"], row["members"]) for row in rows] == [
        ("throughput", "B", 2),
        ("messages", "messages", 2),
        ("airtime", "s", 2),
        ("energy", "J", 1),
    ]
    assert [row["held"] for row in rows] == pytest.approx([row["limit"] / row["members"] for row in rows], rel=0.02)


@pytest.mark.parametrize("coordination", ["announce", "split"])
@pytest.mark.parametrize(("before", "after"), [("", ALL_KINDS), (ALL_KINDS, ""), (ALL_KINDS, UNLIMITED)])
def test_an_answer_is_checked_against_the_constraints_in_force(make_talk, make_specs, coordination, before, after):
    """Specs may come while a sample is decided: it is read again, and decided by what is in force then."""
    talk = make_talk(make_specs(text=before or None), coordination=coordination, settle=0.0, floor=0.0)
    talk.tell(ev.MatchingChanged(0.0, "robot/r1/camera", matching=True))
    sample, commands = talk.publish(0.1)
    reread = only(talk.tell(ev.SpecsChanged(0.2, make_specs(text=after or None))), Reread)
    assert reread == [Reread(sample, "robot/r1/camera")]
    assert only(talk.answer(0.3, only(commands)[0], send=True)) == []
    talk.tell(ev.TimePassed(1.5))  # who splits other limits waits a window: others may have sent under them
    (decided,) = only(talk.tell(ev.SampleReread(1.6, sample, {"red": 0.5})))
    if isinstance(decided, Decide):
        decided = only(talk.answer(1.7, decided, send=True))[0]
    assert decided == Forward(sample)
    assert len(talk.core.status(1.7)["budget"]) == len(talk.core.budget.limits)


def test_others_are_told_how_streams_generate(make_talk):
    """Digests tell of a rhythm; the state tells when it becomes clear that a stream has none."""
    talk = make_talk(allowance=0.02)
    talk.want(0.0)
    for t in periodic(30, jitter=0.02):
        decided(talk, t)
    told = [stream for sent in talk.all(SendDigest) for stream in sent.digest.streams if stream.period > 0.0]
    assert told[-1].period == pytest.approx(1.0, rel=0.1)
    assert told[-1].jitter < 10
    for t in poisson(60, seed=3):
        decided(talk, 36.0 + t)
    kinds = [command.state.streams[0].schedule for command in talk.all(SendState) if command.state.streams]
    assert list(dict.fromkeys(kinds)) == ["", "poisson"]
    assert talk.all(SendState)[-1].state.streams[0].jitter > 0.5
    (told,) = talk.core.status(100.0)["streams"]
    assert (told["schedule"], told["jitter"] > 0.1, told["forecast"]) == ("poisson", True, {})


def test_the_status_tells_what_features_take_and_miss(make_talk, make_specs):
    """Each feature of each type, and what else had to be replaced by a default."""
    text = SPEC.format(limit="80 kbit/s", window=1.0) + 'features.size = { kind = "size", budget = "5 ms" }\n'
    specs = make_specs(text=text)
    (camera,) = specs.types
    camera.failures.note("scale")
    camera.paces.of("size", "k", 0.0).took(0.25, 1.0)
    camera.paces.hold("size")
    found = {row["feature"]: row for row in make_talk(specs).core.status(0.1)["features"]}
    expected = {"type": camera.name, "feature": "size", "failed": 0, "held": 1, "cost": 0.25, "budget": 0.005}
    assert found["size"] == expected
    assert found["scale"] == expected | {"feature": "scale", "failed": 1, "held": 0, "cost": None, "budget": None}


ADAPTIVE = SPEC.replace('limit = "{limit}"', 'limit = "adaptive"\nceiling = "{limit}"')


def test_an_adaptive_limit_follows_the_channel(make_talk, make_specs):
    """It grows while digests come at once; the driver is told the pace, the others what is found."""
    specs = make_specs(text=ADAPTIVE.format(limit="800 kbit/s", window=1.0))
    talk = make_talk(specs, allowance=0.05)
    talk.want(0.0)
    for i in range(400):
        now = 0.05 * i
        said = len(talk.said)
        talk.publish(now, size=2000)
        ours = (talk.all(SendDigest) or [None])[-1]
        echoes = () if ours is None else (Echo("z-r1", ours.digest.sent, 9.0 + now, 0, 0.0),)
        talk.tell(ev.DigestHeard(now + 0.01, Digest("op", "zz-op", 9.0 + now, 0, 0, (), echoes)))
        talk.tell(ev.LinksGauged(now + 0.02, (("zz-op", 0.001), ("nobody", 0.0))))
        for command in talk.said[said:]:
            if isinstance(command, Decide):
                talk.answer(now + 0.03, command, send=True)
    (budget,) = talk.core.status(20.0)["budget"]
    adaptive = budget["adaptive"]
    assert adaptive["in_force"] > 0.3
    assert adaptive["ceiling"] == pytest.approx(95_000.0)
    assert budget["limit"] == pytest.approx(adaptive["in_force"] * adaptive["ceiling"])
    assert budget["held"] <= budget["limit"]
    assert talk.all(SetPace)[0].rate == pytest.approx(math.sqrt(FLOOR) * 100_000.0)
    assert talk.all(SetPace)[-1].rate == pytest.approx(adaptive["in_force"] * 100_000.0)
    told = [sent.digest for sent in talk.all(SendDigest) if not sent.digest.brief][-1].capacity
    assert told[0] == pytest.approx(adaptive["told"], rel=0.2)
    assert told[1:] == pytest.approx((adaptive["used"],), rel=0.2)
    talk.tell(ev.PeerGone(21.0, "op", "zz-op"))
    talk.tell(ev.SpecsChanged(22.0, make_specs()))
    assert "adaptive" not in talk.core.status(22.0)["budget"][0]
    talk.want(30.0)
    talk.tell(ev.TimePassed(60.0))
    assert talk.all(SendDigest)[-1].digest.capacity == ()


def decided(talk, now, **what):
    """Publish a sample that the planner has dropped, if it is asked."""
    for decide in only(talk.publish(now, **what)[1], Decide):
        talk.answer(now, decide, send=False)


def told_by(talk, now=1.0, number=1, **rest):
    """A digest of robot op that speaks of a state."""
    digest = {"robot": "op", "tag": "zz-op", "sent": now, "messages": 0, "bytes": 0, "state": number}
    return talk.tell(ev.DigestHeard(now, Digest(**digest | rest)))


def test_a_newcomer_is_asked_for_its_state_until_it_tells(make_talk):
    """Again and again, more and more slowly, and not any more when it is gone."""
    talk = make_talk()
    assert AskState("op", "zz-op") in talk.tell(ev.PeerAppeared(0.0, "op", "zz-op"))
    for step in range(1, 40):
        talk.tell(ev.TimePassed(0.1 * step))
    assert len(talk.all(AskState)) == 4
    talk.tell(ev.StateHeard(4.0, State("op", "zz-op", "enforce", "", number=1)))
    talk.tell(ev.TimePassed(60.0))
    assert len(talk.all(AskState)) == 4
    talk.tell(ev.PeerAppeared(61.0, "r9", "z-r9"))
    talk.tell(ev.PeerGone(61.1, "r9", "z-r9"))
    talk.tell(ev.TimePassed(120.0))
    assert len(talk.all(AskState)) == 5
    assert talk.core.status(120.0)["asked"] == 5


@pytest.mark.full
def test_a_robot_that_has_to_leave_for_a_new_one_is_asked_no_more(make_talk):
    """However many tokens there are, the core goes on."""
    talk = make_talk()
    talk.want(0.0)
    for number in range(2 * VIEW.peers):
        talk.tell(ev.PeerAppeared(1.0, f"x{number}", f"{number:08x}ff"))
    for step in range(300):
        talk.tell(ev.TimePassed(2.0 + 2.0 * step))
    assert len(talk.all(AskState)) > 200
    assert "op" in {peer["robot"] for peer in talk.core.status(700.0)["peers"]}


def test_a_lost_state_is_asked_for(make_talk):
    """Digests name the state in force; an update of one that we lack is not taken in, the whole one is."""
    talk = make_talk()
    talk.want(0.0)
    asked = len(talk.all(AskState))
    told_by(talk, 1.0, number=0)
    talk.tell(ev.StateHeard(1.0, State("op", "zz-op", "enforce", "", (), ("a/*",), number=3)))
    told_by(talk, 1.1, number=3)
    assert len(talk.all(AskState)) == asked
    told_by(talk, 1.15, number=2)
    told_by(talk, 1.2, number=5)
    assert len(talk.all(AskState)) == asked
    talk.tell(ev.TimePassed(1.25 + GOSSIP.update_delay))
    assert len(talk.all(AskState)) == asked + 1
    update = State("op", "zz-op", "", "", (StreamState(1, "b", "x", 1.0),), number=5, since=4)
    talk.tell(ev.StateHeard(1.6, update))
    assert talk.core.view.peers["zz-op"].state.number == 3
    talk.tell(ev.StateHeard(1.7, State("op", "zz-op", "enforce", "", (), ("b/*",), number=5)))
    assert talk.core.view.peers["zz-op"].state.subscriptions == ("b/*",)
    talk.tell(ev.TimePassed(60.0))
    assert len(talk.all(AskState)) == asked + 1


def test_an_old_state_changes_nothing_unless_digests_speak_of_it(make_talk):
    """Replays are refused; who spoke in another's name with a large number does not silence it."""
    talk = make_talk()
    talk.want(0.0)
    state = State("op", "zz-op", "enforce", "", (), ("a/*",), number=7)
    talk.tell(ev.StateHeard(1.0, state))
    talk.tell(ev.StateHeard(1.1, State("op", "zz-op", "enforce", "", (), ("b/*",), number=6)))
    assert talk.core.view.peers["zz-op"].state.subscriptions == ("a/*",)
    assert talk.core.status(1.1)["refused"] == {"state:old": 1}
    told_by(talk, 1.2, number=6)
    talk.tell(ev.StateHeard(1.3, State("op", "zz-op", "enforce", "", (), ("b/*",), number=6)))
    assert talk.core.view.peers["zz-op"].state.subscriptions == ("b/*",)


def test_a_false_state_gives_way_to_the_one_that_digests_speak_of(make_talk):
    """Somebody tells a state of a high number in a robot's name: what digests of that robot name is asked for."""
    talk = make_talk()
    talk.tell(ev.PeerAppeared(0.0, "op", "zz-op"))
    true = State("op", "zz-op", "enforce", "", (), ("robot/*/camera",), number=3)
    talk.tell(ev.StateHeard(0.1, true))
    talk.tell(ev.DigestHeard(0.2, Digest("op", "zz-op", 0.2, 0, 0, state=3)))
    asked = len(talk.all(AskState))
    talk.tell(ev.StateHeard(1.0, replace(true, subscriptions=(), number=2**50)))
    talk.tell(ev.TimePassed(9.0))
    assert len(talk.all(AskState)) == asked
    talk.tell(ev.DigestHeard(9.0, Digest("op", "zz-op", 9.0, 0, 0, state=3)))
    talk.tell(ev.TimePassed(10.0))
    assert len(talk.all(AskState)) == asked + 1
    talk.tell(ev.StateHeard(10.1, true))
    assert talk.core.view.peers["zz-op"].state.subscriptions == true.subscriptions
    talk.tell(ev.TimePassed(60.0))
    assert len(talk.all(AskState)) == asked + 1


def test_what_a_robot_subscribes_to_is_passed_on_once(make_talk):
    """To whoever counts the copies; nothing any more when it left."""
    talk = make_talk()
    talk.want(0.0)
    talk.want(0.5)
    assert talk.all(NoteInterest) == [NoteInterest("zz-op", ("robot/*/camera",))]
    talk.tell(ev.PeerGone(1.0, "op", "zz-op"))
    assert talk.all(NoteInterest)[-1] == NoteInterest("zz-op", ())


def test_updates_of_the_state_name_what_is_new(make_talk):
    """A first state is whole; a new stream is an update of it; a subscription is told with all the rest."""
    talk = make_talk()
    talk.want(0.0)
    decided(talk, 1.0)
    decided(talk, 2.0, key="robot/x/camera")
    talk.tell(ev.InterestChanged(3.0, ("k",)))
    states = talk.all(SendState)
    assert [sent.state.number for sent in states] == list(range(1, len(states) + 1))
    assert states[0].update is None
    added = next(sent for sent in states if len(sent.state.streams) == 2)
    assert [stream.key for stream in added.update.streams] == ["robot/x/camera"]
    assert added.update.since == added.state.number - 1
    assert (states[-1].update, states[-1].state.subscriptions) == (None, ("k",))
    talk.tell(ev.TimePassed(5.0))
    assert talk.all(SendDigest)[-1].digest.state == states[-1].state.number


def test_small_streams_that_begin_together_are_told_of_together(make_talk, make_specs):
    """A large one is told of at once, with those that are there: others plan with it."""
    talk = make_talk(make_specs(limit="1 MB/s"))
    talk.want(0.0)
    talk.tell(ev.TimePassed(0.9))
    for late, name in ((0.0, "a"), (0.1, "b")):
        decided(talk, 1.0 + late, key=f"robot/{name}/camera", size=100)
    talk.tell(ev.TimePassed(1.2))
    assert [len(sent.state.streams) for sent in talk.all(SendState)][-1] == 0
    talk.tell(ev.TimePassed(1.0 + GOSSIP.gather))
    assert [len(sent.state.streams) for sent in talk.all(SendState)][-1] == 2
    decided(talk, 3.0, key="robot/c/camera", size=100)
    decided(talk, 3.1, key="robot/d/camera", size=100_000)
    assert [len(sent.state.streams) for sent in talk.all(SendState)][-1] == 4


def test_who_asks_for_the_state_is_told_everything_in_the_next_digest(make_talk):
    """Also what others were told long ago."""
    talk = make_talk()
    talk.want(0.0)
    decided(talk, 1.0)
    talk.tell(ev.TimePassed(3.0))
    assert talk.all(SendDigest)[-1].digest.streams == ()
    talk.tell(ev.StateAsked(3.1))
    talk.tell(ev.TimePassed(6.0))
    streams = [stream for sent in talk.all(SendDigest) if sent.digest.sent > 3.0 for stream in sent.digest.streams]
    assert [stream.id for stream in streams] == [1]


def test_digests_that_overtake_a_presence_are_not_lost(make_talk):
    """They count when their robot is introduced; nobody can speak for us."""
    talk = make_talk()
    news = (StreamDigest(7, 3, 1, 0.9, 0.8, 10, 2.0),)
    talk.tell(ev.DigestHeard(1.0, Digest("r2", "z-r2", 1.0, 0, 0, news)))
    talk.tell(ev.DigestHeard(1.0, Digest("r1", "z-r1", 1.0, 0, 0, news)))
    assert talk.core.status(1.0)["refused"] == {"digest:forged": 1}
    talk.tell(ev.PeerAppeared(1.1, "r2", "z-r2"))
    state = State("r2", "z-r2", "enforce", "", (StreamState(7, "robot/r2/camera", "camera", 0.5),))
    talk.tell(ev.StateHeard(1.2, state))
    assert talk.core.view.streams.known("r2", "robot/r2/camera").generated == 3


def test_a_state_of_nobody_changes_nothing(make_talk):
    """It is asked for when its robot is there."""
    talk = make_talk()
    assert only(talk.tell(ev.StateHeard(0.0, State("r2", "z-r2", "", ""))), Notice) == []


def test_two_robots_of_one_name_are_said_loudly(make_talk):
    """An error in the log and a warning in the status, while it lasts."""
    talk = make_talk()
    talk.tell(ev.PeerAppeared(0.0, "r1", "abcdef"))
    (error,) = [notice.text for notice in talk.all(Notice) if notice.level == "error"]
    assert "are called 'r1'" in error
    assert "'r1-abcd' here" in error
    assert talk.core.status(1.0)["warnings"] == [error]
    assert talk.core.status(1.0)["peers"][0]["robot"] == "r1-abcd"
    talk.tell(ev.PeerGone(2.0, "r1", "abcdef"))
    assert talk.core.status(2.0)["warnings"] == []


def test_who_starts_with_a_name_that_is_taken_is_said_loudly(make_talk):
    """It adds a part of its id itself, and everybody says so, be it the own name or that of another robot."""
    talk = make_talk()
    talk.tell(ev.PeerAppeared(0.0, "r2", "abcdef"))
    talk.tell(ev.PeerAppeared(0.1, "r2-beef", "cafe00"))
    assert not [notice for notice in talk.all(Notice) if notice.level == "error"]
    talk.tell(ev.PeerAppeared(0.2, "r2-cafe", "cafe01"))
    talk.tell(ev.PeerAppeared(0.3, "r1-1234", "123456"))
    errors = [notice.text for notice in talk.all(Notice) if notice.level == "error"]
    assert ["called 'r2'" in errors[0], "called 'r1'" in errors[1]] == [True, True]
    assert talk.core.status(1.0)["warnings"] == errors
    talk.tell(ev.PeerGone(2.0, "r2-cafe", "cafe01"))
    assert talk.core.status(2.0)["warnings"] == errors[1:]


def test_the_status_tells_which_streams_are_over_and_no_more_sends_than_samples(make_talk):
    """What was heard from the air is not told of yet; a stream that is silent for four periods is over."""
    talk = make_talk()
    talk.want(0.0)
    for step in range(4):
        talk.publish(1.0 + step)
    (stream,) = talk.core.view.streams.own()
    stream.forwarded = 9
    (told,) = talk.core.status(5.0)["streams"]
    assert (told["over"], told["generated"], told["forwarded"]) == (False, 9, 9)
    (told,) = talk.core.status(15.0)["streams"]
    assert told["over"]


def test_a_robot_that_starts_anew_is_heard_again(make_talk):
    """Its digests count after a silence, though their time is before that of the last one."""
    talk = make_talk()
    talk.want(0.0)
    told_by(talk, 1.0, sent=5000.0)
    told_by(talk, 2.0, sent=3.0)
    assert talk.core.status(2.0)["refused"] == {"digest:old": 1}
    told_by(talk, 12.0, sent=13.0)
    assert talk.core.view.peers["zz-op"].digest.sent == 13.0


def test_features_and_scale_are_used_as_they_are_told(make_talk):
    """Equal views give equal plans: the sender rounds what the wire would."""
    talk = make_talk()
    talk.want(0.0)
    talk.publish(1.0, red=0.123456789)
    talk.tell(ev.TimePassed(3.0))
    (stream,) = talk.core.view.streams.own()
    told = next(s for sent in talk.all(SendDigest) for s in sent.digest.streams)
    assert told.scale == stream.newest.scale == rounded(stream.newest.scale)
    assert stream.newest.features["red"] == single(0.123456789)


def test_news_that_nobody_wants_is_not_urgent(make_talk):
    """It waits for the next digest."""
    talk = make_talk()
    talk.tell(ev.PeerAppeared(0.0, "op", "zz-op"))
    talk.tell(ev.TimePassed(1.0))
    talk.publish(1.1, red=0.1)
    assert not talk.core.gossip.digests.urgent
    talk.want(1.2)
    talk.publish(1.3, red=0.9)
    assert talk.core.gossip.digests.urgent or talk.all(SendDigest)[-1].digest.sent == 1.3


def test_what_is_too_much_to_tell_is_said(make_talk):
    """Once, and counted in the status."""
    talk = make_talk()
    talk.tell(ev.InterestChanged(1.0, tuple(f"k{n}" for n in range(1100))))
    talk.tell(ev.ModeChanged(2.0, Mode.SHADOW))
    (warning,) = [notice for notice in talk.all(Notice) if notice.level == "warning"]
    assert warning.text == "76 streams, subscriptions or origins are too many to tell the others"
    assert warning.fields["reason"] == "untold"  # of which few are logged, however often the number changes
    assert talk.core.status(2.0)["untold"] == 76
