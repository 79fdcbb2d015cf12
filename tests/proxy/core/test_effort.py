"""What an event touches, by a profiler's count: calls and files of the core, not time."""

import sys
from collections import Counter
from pathlib import Path
from statistics import median

import proxy.core.core
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Forward
from proxy.core.protocol.messages import State

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


def test_a_sample_for_which_there_is_room_is_little_work(make_talk, make_specs):
    """No queue, no look at what room costs or at what is to be told; and next to nothing when it was handed over.

    That is once it is known that all fits: the first samples of a stream are looked at more closely.
    """
    talk = make_talk(make_specs("100 Mbit/s"), allowance=0.02)
    talk.want(0.0)
    sent, handed = [], []
    for number in range(1, 201):
        now, key = 1.0 + 0.005 * number, f"robot/r{number % 10}/camera"
        talk.tell(ev.TimePassed(now - 0.001))
        commands, calls = touched(talk.tell, published(now, number, key))
        for decide in [each for each in commands if isinstance(each, Decide)]:
            commands = talk.answer(now, decide, send=True)
        assert Forward(number) in commands
        sent.append(calls)
        handed.append(touched(talk.tell, ev.SampleHanded(now + 0.001, number))[1])
    assert median(calls.total() for calls in sent[100:]) <= 260
    assert median(map(len, sent[100:])) <= 56
    assert median(calls.total() for calls in handed[100:]) <= 40
    assert median(map(len, handed[100:])) <= 20


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
