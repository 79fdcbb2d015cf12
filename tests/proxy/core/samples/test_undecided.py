"""What is undecided: in which order it is decided, and what leaves before."""

import pytest
from hypothesis import HealthCheck, given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward
from proxy.core.model.mode import Mode
from proxy.core.model.waiting import Waiting
from proxy.core.protocol.messages import Digest, State
from proxy.core.samples.undecided import Deletions
from tests.proxy.core.samples.answers import decide_all
from tests.proxy.core.talk import only

AGGREGATIONS = ["most_recent", "best", "sum", "once"]

STEPS = [*["publish"] * 6, *["delete"] * 2, *["answer"] * 3, "hand", "refuse", "mode", "join"]


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


MOST = min(150, 2 * hypothesis_settings().max_examples)


@hypothesis_settings(deadline=None, max_examples=MOST, suppress_health_check=[HealthCheck.function_scoped_fixture])
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


def waiting(sample, key="a"):
    return Waiting(sample, key, 100, 0.0, 1.0, 5, markovian=False)


def test_a_deletion_passes_behind_all_that_was_undecided_of_its_key():
    """Other keys do not hold it up."""
    deletions = Deletions()
    deletions.add(9, "a", [waiting(1), waiting(2), waiting(3, "b")])
    assert deletions.due([waiting(2), waiting(3, "b")]) == []
    assert deletions.due([waiting(3, "b")]) == [9]
    assert deletions.due([]) == []


def test_with_nothing_before_it_a_deletion_is_due_at_once():
    """In the order in which they came."""
    deletions = Deletions()
    deletions.add(8, "a", [waiting(3, "b")])
    deletions.add(9, "b", [])
    assert deletions.due([waiting(3, "b")]) == [8, 9]


def test_what_comes_after_a_deletion_is_held_until_it_passed():
    """What came before it is not, nor another key."""
    deletions = Deletions()
    deletions.add(9, "a", [waiting(1)])
    assert [deletions.holds(each) for each in (waiting(1), waiting(10), waiting(11, "b"))] == [False, True, False]
    deletions.due([])
    assert not deletions.holds(waiting(10))
