"""What was dropped although nobody decided so is said in the log, but not for each sample."""

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Forward, Notice
from tests.proxy.core.talk import UNLIMITED


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
