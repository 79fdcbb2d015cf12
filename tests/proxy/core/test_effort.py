"""What an event touches, by a profiler's count: calls and files of the core, not time."""

import sys
from collections import Counter
from pathlib import Path
from statistics import median

import pytest

import proxy.core.core
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Forward, SendDigest
from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState

CORE = str(Path(proxy.core.core.__file__).parent)


def touched(tell, event):
    """Hand an event over; return the commands, and how many calls it makes in each file of the core."""
    calls = Counter()

    def count(frame, what, _):
        if what == "call" and frame.f_code.co_filename.startswith(CORE):
            calls[frame.f_code.co_filename] += 1

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        commands = tell(event)
    finally:
        sys.setprofile(before)
    return commands, calls


def published(now, sample, key):
    return ev.SamplePublished(now, sample, key, 100, now, None, 5, {"red": 0.0})


def flown(talk, numbers):
    """Publish samples of these numbers, of ten streams and 200 a second; time passes among them as the core asks for.

    Return what each touched, and what it touched that each was handed over; and how many calls all events made.
    """
    published_, handed, whole = [], [], Counter()

    def count(event):
        commands, calls = touched(talk.tell, event)
        whole.update(calls)
        return commands, calls

    for number in numbers:
        at = 1.0 + 0.005 * number
        now = at - 0.003
        while (wake := talk.core.wake_at(now)) < at:
            now = wake + 1e-4
            count(ev.TimePassed(now))
        now = at
        commands, calls = count(published(now, number, f"robot/r{number % 10}/camera"))
        for decide in [each for each in commands if isinstance(each, Decide)]:
            commands = talk.answer(now, decide, send=True)
        assert Forward(number) in commands
        published_.append(calls)
        handed.append(count(ev.SampleHanded(now + 0.001, number))[1])
    return published_, handed, whole.total()


def test_an_undisputed_sample_touches_few_files(make_talk, make_specs):
    """No queue, no look at what room costs or at what is to be told: what it changes is entered when that is read.

    That is once it is known how often streams generate: their first samples are looked at more closely. Nor may the
    work only move elsewhere: all events together, those that enter what was noted included, take few calls a sample.
    """
    talk = make_talk(make_specs("100 Mbit/s"), allowance=0.02)
    talk.want(0.0)
    flown(talk, range(1, 401))
    sent, handed, whole = flown(talk, range(401, 801))
    assert median(map(len, sent)) <= 3
    assert sum(len(files) > 12 for files in sent) <= 0.05 * len(sent)
    assert median(calls.total() for calls in sent) <= 8
    assert median(map(len, handed)) <= 4
    assert median(calls.total() for calls in handed) <= 10
    assert whole <= 130 * len(sent)


def test_what_is_heard_is_little_work_however_many_streams_there_are(make_talk, make_specs):
    """A sample of another robot touches its own stream."""
    counts = {}
    for streams in (1, 100):
        talk = make_talk(make_specs(), transport="broadcast:g")
        talk.tell(ev.PeerAppeared(0.0, "op", "aa"))
        talk.tell(ev.StateHeard(0.0, State("op", "aa", "enforce", "", transport="broadcast:g", number=1), 100))
        heard = []
        for number in range(400):
            now = 1.0 + 0.01 * number
            talk.tell(ev.TimePassed(now - 0.001))
            event = ev.SampleHeard(now, f"robot/op{number % streams}/camera", 100, "aa", None, None)
            heard.append(touched(talk.tell, event)[1].total())
        counts[streams] = median(heard[200:])
    assert counts[100] <= 1.5 * counts[1]
    assert counts[1] <= 60


@pytest.mark.full
def test_which_streams_ceased_is_not_looked_for_at_each_digest(make_talk, make_specs):
    """Of a thousand streams, under a limit that leaves much to digests, that took 40 % of the robot's time."""
    talk, streams = make_talk(make_specs("80 Mbit/s"), allowance=0.02), 200
    told = (StreamState(1, "robot/op/camera", "camera", 1.0, 0.0, 30_000),)
    talk.tell(ev.PeerAppeared(0.0, "op", "zz-op"))
    talk.tell(ev.StateHeard(0.0, State("op", "zz-op", "enforce", "", told, ("robot/**",), number=1), 200))
    calls = Counter()
    for number in range(1000):
        now = 1.0 + 0.001 * number
        if number % 200 == 0:
            count = number // 200 + 1
            news = StreamDigest(1, count, count, now - 0.002, now - 0.001, 30_000, 1.0)
            talk.tell(
                ev.DigestHeard(now, Digest("op", "zz-op", now - 0.001, count, 30_000 * count, (news,), state=1), 60)
            )
        commands, seen = touched(talk.tell, published(now, number, f"robot/r{number % streams}/camera"))
        calls += seen
        for decide in [each for each in commands if isinstance(each, Decide)]:
            talk.answer(now, decide, send=True)
    assert len(talk.all(SendDigest)) > 100
    (looks,) = [count for path, count in calls.items() if path.endswith("gossip/announcements.py")]
    assert looks <= 60 * streams
