"""The fast path sends at once what surely may go, and leaves all as if it had gone the long way."""

import pytest

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward
from proxy.core.model.mode import Mode
from proxy.core.protocol.messages import Digest, tag
from proxy.core.reactions.fast_path import FastPath
from tests.proxy.core.talk import only


@pytest.fixture
def passed(monkeypatch):
    """How many events the fast path took."""
    counted, take = [], FastPath.take

    def count(self, event):
        commands = take(self, event)
        counted.extend([event] if commands is not None and isinstance(event, ev.SamplePublished) else [])
        return commands

    monkeypatch.setattr(FastPath, "take", count)
    return counted


def flown(talk, samples=600, *, others=False):
    """Publish samples of five streams, 200 a second; each is handed over, and time passes as the core asks for.

    Who wants them says that it sends nothing.
    """
    talk.want(0.0)
    now = 0.5
    for number in range(1, samples + 1):
        at = 1.0 + 0.005 * number
        while (wake := talk.core.wake_at(now)) < at:
            now = max(wake, now + 1e-4)
            talk.tell(ev.TimePassed(now))
        now = at
        if number % 100 == 0:
            talk.tell(ev.DigestHeard(now - 0.001, Digest("op", tag("zz-op"), now - 0.002, 0, 0), 40))
        if others and number % 7 == 0:
            talk.tell(ev.SampleHeard(now - 0.001, "robot/plain/camera", 900, "feed", None, None))
        sample, commands = talk.publish(now, f"robot/r{number % 5}/camera", size=90 + number % 13)
        for decide in only(commands, Decide):
            commands = talk.answer(now, decide, send=True)
        if Forward(sample) in commands:
            talk.tell(ev.SampleHanded(now + 0.001, sample))
    return now


@pytest.mark.parametrize("transport", ["unicast", "broadcast:g"])
def test_all_is_as_on_the_long_way(make_talk, make_specs, monkeypatch, passed, transport):
    """The same is sent and told at the same times, and whoever looks at it finds the same.

    In broadcast beside a plain node, which is overheard.
    """
    ways, others = [], transport != "unicast"
    for fast in (True, False):
        if not fast:
            took = len(passed)
            monkeypatch.setattr(FastPath, "open", lambda *_: None)
        talk = make_talk(make_specs("8 Mbit/s"), allowance=0.02, transport=transport)
        now = flown(talk, others=others)
        ways.append((talk.said, talk.core.status(now), talk.core.why(now, "robot/r1/camera", 9, 0)))
    assert took > 300
    assert len(passed) == took
    assert ways[0] == ways[1]


def test_it_ends_with_the_room(make_talk, make_specs, passed):
    """What it sends counts: a burst beyond the limit is decided on, however much room there seemed to be."""
    talk = make_talk(make_specs("800 kbit/s"), allowance=0.02)
    now = flown(talk)
    assert passed
    before = len(passed)
    for _ in range(1000):
        sample, commands = talk.publish(now, "robot/r1/camera", size=100)
        if Forward(sample) not in commands:
            break
        now += 1e-5
    limit = talk.core.budget.limits[0]
    assert len(passed) > before
    assert talk.core.budget.used(now, 0) <= limit.limit
    assert not only(commands, Forward)


def test_others_samples_take_room(make_talk, make_specs, passed):
    """What is heard of others since it was opened is counted before the next sample goes."""
    talk = make_talk(make_specs("800 kbit/s"), allowance=0.02)
    now = flown(talk)
    for number in range(1, 120):
        talk.tell(ev.SampleHeard(now + 1e-5 * number, f"robot/p{number}/camera", 1000, "feed", None, None))
    before = len(passed)
    _, commands = talk.publish(now + 0.002, "robot/r1/camera", size=100)
    assert len(passed) == before
    assert not only(commands, Forward)


@pytest.mark.parametrize(
    "change",
    [
        lambda talk, now: talk.tell(ev.ModeChanged(now, Mode.SHADOW)),
        lambda talk, now: talk.tell(ev.SpecsChanged(now, talk.core.view.specs)),
        lambda talk, now: talk.tell(ev.PeerGone(now, "op", "zz-op")),
        lambda talk, now: talk.tell(ev.MatchingChanged(now, "robot/r1/camera", matching=True)),
    ],
    ids=["mode", "specs", "a robot that left", "demand"],
)
def test_a_change_closes_it(make_talk, make_specs, passed, change):
    """The next sample of each stream is looked at closely."""
    talk = make_talk(make_specs("8 Mbit/s"), allowance=0.02)
    now = flown(talk)
    change(talk, now + 0.001)
    before = len(passed)
    talk.publish(now + 0.002, "robot/r1/camera", size=90)
    assert len(passed) == before


def test_another_value_goes_the_long_way(make_talk, make_specs, passed):
    """Others may plan anew by it: a digest tells them at once."""
    talk = make_talk(make_specs("8 Mbit/s"), allowance=0.02)
    now = flown(talk)
    before = len(passed)
    sample, commands = talk.publish(now + 0.002, "robot/r1/camera", size=90, red=0.9)
    assert len(passed) == before
    assert only(commands, Forward, Drop) == [Forward(sample)]
