"""The law of conservation."""

from hypothesis import given
from hypothesis import strategies as st

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Forward, Notice
from proxy.core.samples.counts import Counts
from tests.proxy.core.talk import UNLIMITED


@given(st.lists(st.sampled_from(["enter", "approve", "hand", "drop", "pass"]), max_size=80), st.randoms())
def test_the_law_holds_after_every_step(steps, rng):
    """in = forwarded + dropped + queued, whatever happens in whatever order."""
    counts, waiting, approved, number = Counts(), [], [], 0
    for step in steps:
        if step == "enter":
            counts.enter(number)
            waiting.append(number)
            number += 1
        elif step == "approve" and waiting:
            approved.append(waiting.pop(rng.randrange(len(waiting))))
            counts.approve(approved[-1], "forwarded")
        elif step == "hand" and approved:
            counts.hand(approved.pop(rng.randrange(len(approved))))
        elif step == "drop" and waiting:
            counts.drop(waiting.pop(rng.randrange(len(waiting))), "dropped:planner")
        elif step == "pass":
            counts.passed(3, "passed:no-spec")
        assert counts.conserved
        assert counts.queued == len(waiting) + len(approved)


def test_why_a_sample_was_approved_is_known_until_it_is_handed_over():
    """Nothing before."""
    counts = Counts()
    counts.enter(1, "a")
    assert not counts.approved(1)
    counts.approve(1, "forwarded")
    assert counts.approved(1) == "forwarded"


def test_reasons_are_counted_apart():
    """Every sample is counted once under what became of it."""
    counts = Counts()
    for sample in range(3):
        counts.enter(sample)
    counts.approve(0, "forwarded")
    counts.hand(0)
    counts.drop(1, "dropped:superseded")
    assert counts.by_reason == {"forwarded": 1, "dropped:superseded": 1}
    assert (counts.received, counts.forwarded, counts.dropped, counts.queued) == (3, 1, 1, 1)


def test_bytes_of_what_passed_are_summed_by_reason():
    """What goes without a decision is told with what it took of the air."""
    counts = Counts()
    counts.passed(2, "passed:bypass", 300)
    counts.passed(1, "passed:bypass", 50)
    assert (counts.by_reason["passed:bypass"], counts.bytes["passed:bypass"]) == (3, 350)


def test_what_is_decided_is_counted_by_information_type():
    """However many streams it covers."""
    counts = Counts()
    counts.generate("pose", 3)
    counts.decide("pose", "forwarded", 1)
    counts.decide("pose", "dropped:superseded", 2)
    assert counts.generated == {"pose": 3}
    assert counts.decided == {("pose", "forwarded"): 1, ("pose", "dropped:superseded"): 2}


def said(commands):
    return [command.text for command in commands if isinstance(command, Notice)]


def test_it_is_said_at_once_and_then_once_a_minute(make_talk):
    """With how many there were since; each reason for itself, and nothing of what was decided."""
    talk = make_talk()
    assert not said(talk.tell(ev.SamplesPassed(1.0, "dropped:denied", 1, 0)))
    (first,) = said(talk.tell(ev.SamplesPassed(1.0, "dropped:full", 1, 0)))
    assert "mesh" in first
    assert first.endswith("1, 1 in all (dropped:full)")
    assert not said(talk.tell(ev.SamplesPassed(2.0, "dropped:full", 3, 0)))
    (other,) = said(talk.tell(ev.SamplesPassed(3.0, "dropped:overflow", 1, 0)))
    assert "decided" in other
    (later,) = said(talk.tell(ev.TimePassed(61.5)))
    assert later.endswith("3, 4 in all (dropped:full)")
    assert not said(talk.tell(ev.TimePassed(200.0)))


def test_a_sample_that_the_mesh_does_not_take_is_said(make_talk, make_specs):
    """With the reason that the driver gives."""
    talk = make_talk(make_specs(text=UNLIMITED))
    talk.want(0.0)
    sample, _ = talk.publish(1.0)
    assert [command.sample for command in talk.all(Forward)] == [sample]
    (line,) = said(talk.tell(ev.SampleRefused(1.1, sample)))
    assert "dropped:egress" in line


def test_programs_find_the_reason_and_the_counts(make_talk):
    """They need not read the text."""
    (notice,) = [
        each for each in make_talk().tell(ev.SamplesPassed(1.0, "dropped:full", 3, 0)) if isinstance(each, Notice)
    ]
    assert notice.fields == {"reason": "dropped:full", "new": 3, "total": 3}
