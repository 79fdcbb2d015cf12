"""Specs that change while samples wait: each is worth what the specs in force say, and none is lost."""

import pytest

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward, Reread
from proxy.core.model.mode import Mode
from tests.proxy.core.talk import UNLIMITED, only

WEIGHED = """
[[constraint]]
kind = "messages"
limit = 20
window = 1.0
[[information_type]]
name = "any"
keys = ["robot/r1/*"]
weight = {}
utility = {{ kind = "linear", slope = 0.5 }}
"""


def test_no_decision_mixes_two_generations_of_specs(make_talk, make_specs):
    """Whatever a window holds is worth what the specs in force say: facts, the sample itself, those that wait."""
    talk = make_talk(make_specs(text=WEIGHED.format(1)))
    for name in ("a", "b"):
        talk.tell(ev.MatchingChanged(0.0, f"robot/r1/{name}", matching=True))
    decides = []
    for i in range(60):
        t = 0.1 * i
        for name in ("a", "b"):
            _, commands = talk.publish(t, key=f"robot/r1/{name}")
            decides += only(commands, Decide)
        if i % 7 == 6:
            for command in only(talk.tell(ev.SpecsChanged(t, make_specs(text=WEIGHED.format(10**i)))), Reread):
                decides += only(talk.tell(ev.SampleReread(t, command.sample, {})), Decide)
        if i % 3 == 0:
            while talk.core.gate.search.pending is not None:
                ticket = talk.core.gate.search.pending.ticket
                (asked,) = (each for each in decides if each.ticket == ticket)
                decides += only(talk.answer(t, asked, send=i % 2 == 0), Decide)
    scales = [{message.scale for message in command.problem.messages} for command in decides]
    assert {len(each) for each in scales} == {1}
    assert len(set.union(*scales)) > 3


def test_what_waits_is_read_again_when_specs_change(make_talk, make_specs):
    """It keeps its place; it passes when nothing covers it any more, and when the mode becomes `pass` meanwhile."""
    talk = make_talk(make_specs(text=WEIGHED.format(1)))
    for name in ("a", "b", "c"):
        talk.tell(ev.MatchingChanged(0.0, f"robot/r1/{name}", matching=True))
    samples = [talk.publish(0.1, key=f"robot/r1/{name}")[0] for name in ("a", "b", "c")]
    reread = only(talk.tell(ev.SpecsChanged(0.2, make_specs(text=WEIGHED.format(2).replace("*", "a")))), Reread)
    assert sorted(command.sample for command in reread) == samples
    assert talk.core.counts.queued == 3
    assert only(talk.tell(ev.SampleReread(0.2, samples[1], {})), Forward) == [Forward(samples[1])]
    again = only(talk.tell(ev.SpecsChanged(0.3, make_specs(text=WEIGHED.format(3)))), Reread)
    assert sorted(command.sample for command in again) == [samples[0], samples[2]]
    released = only(talk.tell(ev.ModeChanged(0.4, Mode.PASS)), Forward)
    assert sorted(command.sample for command in released) == [samples[0], samples[2]]
    assert only(talk.tell(ev.SampleReread(0.5, samples[0], {}))) == []
    assert talk.core.counts.by_reason["passed:no-spec"] == 0
    assert talk.core.counts.conserved


def test_a_sample_that_is_gone_when_it_is_read_again_is_counted(make_talk, make_specs):
    """Nothing waits for it any more."""
    talk = make_talk(make_specs(text=WEIGHED.format(1)))
    talk.tell(ev.MatchingChanged(0.0, "robot/r1/a", matching=True))
    sample, _ = talk.publish(0.1, key="robot/r1/a")
    talk.tell(ev.SpecsChanged(0.2, make_specs(text=WEIGHED.format(2))))
    talk.tell(ev.SampleRefused(0.3, sample))
    assert (talk.core.counts.queued, talk.core.counts.by_reason) == (0, {"dropped:egress": 1})
    assert only(talk.tell(ev.SpecsChanged(0.4, make_specs(text=WEIGHED.format(3)))), Reread) == []


def test_a_newer_sample_supersedes_one_that_is_read_again(make_talk, make_specs):
    """As it does while samples wait for their decisions."""
    talk = make_talk(make_specs(text=WEIGHED.format(1)))
    talk.tell(ev.MatchingChanged(0.0, "robot/r1/a", matching=True))
    older, _ = talk.publish(0.1, key="robot/r1/a")
    talk.tell(ev.SpecsChanged(0.2, make_specs(text=WEIGHED.format(2))))
    talk.publish(0.3, key="robot/r1/a")
    assert only(talk.tell(ev.SampleReread(0.4, older, {})), Drop) == [Drop(older, "dropped:superseded")]
    assert talk.core.counts.conserved


@pytest.fixture
def reread(make_talk, make_specs):
    """Samples of b and a, a deletion of b behind its own, and then these specs: what is to be read again."""

    def change(specs):
        talk = make_talk(make_specs(text=WEIGHED.format(1)))
        for name in ("a", "b"):
            talk.tell(ev.MatchingChanged(0.0, f"robot/r1/{name}", matching=True))
        b, a = (talk.publish(0.1, key=f"robot/r1/{name}")[0] for name in ("b", "a"))
        delete, nothing = talk.publish(0.2, key="robot/r1/b", size=0, delete=True)
        assert only(nothing) == []
        assert only(talk.tell(ev.SpecsChanged(0.3, make_specs(text=specs))), Reread)
        return talk, (a, b, delete)

    return change


AMPLE, ELSEWHERE = WEIGHED.format(1).replace("limit = 20", "limit = 100000"), WEIGHED.format(1).replace("r1", "r2")


@pytest.mark.parametrize("specs", [AMPLE, ELSEWHERE], ids=["ample", "uncovered"])
def test_a_deletion_follows_a_sample_that_is_read_again(reread, specs):
    """Also where that goes at once, as there is room for all, or nothing covers it any more."""
    talk, (a, b, delete) = reread(specs)
    talk.tell(ev.SampleReread(0.31, a, {}))
    assert delete not in [command.sample for command in talk.all(Forward)]
    talk.tell(ev.SampleReread(0.32, b, {}))
    later, _ = talk.publish(0.5, key="robot/r1/b")
    talk.tell(ev.TimePassed(0.6))
    assert talk.all(Forward) == [Forward(sample) for sample in (a, b, delete, later)]


def test_a_deletion_passes_where_the_sample_before_it_is_refused_before_it_is_read_again(reread):
    """There is nothing before it any more."""
    talk, (_, b, delete) = reread(AMPLE)
    assert only(talk.tell(ev.SampleRefused(0.31, b))) == [Forward(delete)]


def test_nothing_overtakes_a_deletion_that_waits_for_a_sample_to_be_read_again(reread):
    """However much room there is."""
    talk, (a, b, delete) = reread(AMPLE)
    talk.tell(ev.SampleReread(0.31, a, {}))
    later, nothing = talk.publish(0.32, key="robot/r1/b")
    assert only(nothing) == []
    talk.tell(ev.SampleReread(0.33, b, {}))
    talk.tell(ev.TimePassed(0.4))
    assert talk.all(Drop) == [Drop(b, "dropped:superseded")]
    assert talk.all(Forward) == [Forward(sample) for sample in (a, delete, later)]


def test_what_specs_cover_no_more_goes_behind_samples_of_its_key_that_wait(reread):
    """It may come before these are read again: they pass first, and a deletion in its place."""
    talk, (a, b, delete) = reread(ELSEWHERE)
    later, _ = talk.publish(0.31, key="robot/r1/b")
    for sample in (a, b):
        talk.tell(ev.SampleReread(0.32, sample, {}))
    assert talk.all(Forward) == [Forward(sample) for sample in (b, delete, later, a)]


def test_types_that_are_gone_leave_no_counts(make_talk, make_specs):
    """However often specs are edited there are no more than the types in force; what they counted goes on."""
    talk = make_talk(make_specs(text=UNLIMITED + WEIGHED.format(1)))
    talk.tell(ev.InterestChanged(0.0, ("**",)))
    talk.want(0.0)
    for key in ("robot/r1/camera", "robot/r1/any"):
        talk.publish(0.1, key=key)
    types = talk.core.totals(0.2)["types"]
    assert types.keys() == {"camera", "any"}
    talk.tell(ev.SpecsChanged(0.3, make_specs(text=UNLIMITED)))
    assert talk.core.totals(0.4)["types"] == {"camera": types["camera"]}
