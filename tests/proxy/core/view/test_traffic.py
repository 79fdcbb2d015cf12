"""What goes on the air, ours and that of others."""

from proxy.core.view.stream import Sent
from tests.proxy.core.view.met import meet


def sent(view, robot, at, size=100):
    stream = view.streams.touch(at, robot, f"robot/{robot}/camera")
    view.traffic.note_sent(stream, stream.forwarded + 1, Sent(at, at, size, 1.0))


def test_only_what_others_sent_is_looked_back_on(view):
    """Of our own sends the largest counts, all copies of it, until it is announced."""
    meet(view, subscriptions=("robot/r1/camera",))
    for at, size in ((1.0, 300), (2.0, 200)):
        sent(view, "r1", at, size)
    sent(view, "r2", 2.5)
    assert view.traffic.sent_since(0.0) == [(2.5, (100, 1), "r2", True)]
    assert view.traffic.largest == 300
    view.traffic.announced()
    assert view.traffic.largest == 0


def test_what_was_sent_of_an_unknown_stream_is_taken_back_once(view):
    """When it is known of which stream it was."""
    entry, traffic = view.traffic.note_unknown(1.0, 50, "r2"), view.traffic
    assert traffic.sent_since(1.0) == [entry] == [(1.0, (50, 1), "r2", False)]
    traffic.retract([entry])
    revision = traffic.revision
    traffic.retract([entry])
    assert (traffic.sent_since(0.0), traffic.revision) == ([], revision)


class Time(float):
    """A time that counts how often it is compared with another one."""

    compared = 0

    def __eq__(self, other):
        Time.compared += 1
        return float(self) == other

    __hash__ = float.__hash__


def test_what_was_sent_of_many_unknown_streams_is_taken_back_at_once(view):
    """In one look at all sends, not one for each; of two that are equal one stays."""
    traffic = view.traffic
    twice = [traffic.note_unknown(1.0, 50, "r2") for _ in range(2)]
    entries = [traffic.note_unknown(Time(number), 50, "r2") for number in range(2, 300)]
    traffic.retract([*reversed(entries), twice[0]])
    assert traffic.sent_since(0.0) == twice[1:]
    assert traffic.retracted == len(entries) + 1
    assert Time.compared <= 10 * len(entries)


def test_what_no_window_counts_is_forgotten(view):
    """Some time after the window: who waited for their room may still send."""
    for at in (1.0, 2.0, 4.0):
        view.traffic.note_unknown(at, 50, "r2")
    view.traffic.sweep(5.0, 2.0)
    assert [at for at, *_ in view.traffic.sends] == [2.0, 4.0]
    revision = view.traffic.revision
    view.traffic.sweep(5.0, 2.0)
    assert view.traffic.revision == revision
