"""Modes of the daemon and of information types, and what specs leave to others, as transcripts."""

import pytest

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward
from proxy.core.model.mode import Mode, in_force
from tests.proxy.core.talk import SPEC, only

ROUGH = SPEC.format(limit="80 kbit/s", window=1.0)


@pytest.mark.parametrize(
    ("daemon", "said", "mode"),
    [
        (Mode.SHADOW, None, Mode.SHADOW),
        (Mode.SHADOW, "enforce", Mode.ENFORCE),
        (Mode.ENFORCE, "shadow", Mode.SHADOW),
        (Mode.ENFORCE, "pass", Mode.PASS),
        (Mode.PASS, "enforce", Mode.PASS),
    ],
)
def test_a_type_may_have_its_own_mode_unless_the_daemon_is_a_plain_bridge(daemon, said, mode):
    """An operator who switches to `pass` gets a bridge."""
    assert in_force(daemon, said) is mode


@pytest.fixture
def make_said(make_talk, make_specs):
    """A core whose spec says this, and this of its cameras, that are wanted."""

    def make(camera="", top="", **settings):
        text = top + ROUGH.replace('name = "camera"', f'name = "camera"\n{camera}')
        talk = make_talk(make_specs(text=text), coordination="split", settle=0.0, floor=0.0, **settings)
        talk.tell(ev.MatchingChanged(0.0, "robot/r1/camera", matching=True))
        return talk

    return make


def test_a_type_in_shadow_goes_whatever_is_decided_and_takes_of_what_is_left(make_said):
    """It is on the air, and what is enforced has to do with the rest."""
    talk = make_said('mode = "shadow"')
    sample, commands = talk.publish(0.1, size=4000)
    before = talk.core.budget.used(0.11, 0)
    assert only(talk.answer(0.11, only(commands)[0], send=False)) == [Forward(sample)]
    assert talk.core.budget.used(0.11, 0) > before


def test_a_type_may_be_enforced_while_others_are_watched(make_said):
    """So a team starts with one of them."""
    talk = make_said('mode = "enforce"', mode=Mode.SHADOW)
    sample, commands = talk.publish(0.1)
    assert only(talk.answer(0.11, only(commands)[0], send=False)) == [Drop(sample, "dropped:planner")]


@pytest.mark.parametrize(("said", "reason"), [("bypass = true", "passed:bypass"), ('mode = "pass"', "passed:mode")])
def test_what_is_not_planned_passes_at_once_and_is_counted(make_said, said, reason):
    """It may exceed the limit, has no stream in the view, and lowers what is left for others."""
    talk = make_said(said)
    sample, commands = talk.publish(0.1, size=50_000)
    assert only(commands) == [Forward(sample)]
    talk.tell(ev.SampleHanded(0.2, sample))
    assert talk.core.counts.by_reason == {reason: 1}
    assert list(talk.core.view.streams) == []
    assert talk.core.budget.used(0.2, 0) > 0.0


def test_a_type_that_is_planned_no_more_leaves_the_view(make_said, make_specs):
    """New specs hold at once."""
    talk = make_said()
    talk.publish(0.1)
    talk.tell(ev.SpecsChanged(0.2, make_specs(text=ROUGH.replace('name = "camera"', 'name = "camera"\nbypass = true'))))
    assert list(talk.core.view.streams) == []


def test_a_delete_may_be_decided_like_a_sample(make_said):
    """It has the default features, and an older sample of its stream gives way to it."""
    talk = make_said('deletes = "decide"')
    first, commands = talk.publish(0.1, red=1.0)
    second, _ = talk.publish(0.2)
    delete, nothing = talk.publish(0.3, size=400, delete=True)
    assert only(nothing) == [Drop(second, "dropped:superseded")]
    forward, decide = only(talk.answer(0.31, only(commands)[0], send=True))
    assert forward == Forward(first)
    assert decide.problem.messages[decide.problem.current].scale == 1.0
    assert only(talk.answer(0.32, decide, send=False))[0] == Drop(delete, "dropped:planner")


@pytest.mark.parametrize(
    ("rule", "priority", "outcome"),
    [
        ("", 5, Drop),
        ("", 4, Forward),
        ('fallback = { urgent = "data" }\n', 5, Forward),
        ('fallback = { part = "100 %" }\n', 5, Forward),
        ('fallback = { urgent = "real_time", part = 0.1 }\n', 4, Drop),
    ],
)
def test_specs_say_what_decides_when_the_planner_fails(make_said, rule, priority, outcome):
    """Who is urgent may take all that is left, others a part of it."""
    talk = make_said(top=rule)
    talk.tell(ev.SamplesPassed(0.1, "passed:no-spec", 1, 2000))
    _, commands = talk.publish(0.1, size=4500, priority=priority)
    (decide,) = only(commands, Decide)
    commands = talk.tell(ev.DecisionReady(0.2, decide.ticket, None, "boom"))
    assert [type(command) for command in only(commands)] == [outcome]


@pytest.mark.parametrize(("top", "outcome"), [("", Forward), ('floor = "0 %"\n', Drop)])
def test_specs_say_what_traffic_without_a_spec_leaves(make_said, top, outcome):
    """A tenth of the limit unless they say otherwise."""
    talk = make_said(top=top)
    talk.tell(ev.SamplesPassed(0.1, "passed:no-spec", 1, 100_000))
    _, commands = talk.publish(0.2, size=900)
    decides = only(commands, Decide)
    commands = talk.answer(0.21, decides[0], send=True) if decides else commands
    assert [type(command) for command in only(commands)] == [outcome]
