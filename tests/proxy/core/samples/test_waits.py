"""Samples that wait for room, or for news of what others sent, as transcripts."""

import pytest

from proxy.core.coordination.claims import news_take
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward
from proxy.core.protocol.messages import State, StreamState
from proxy.core.view.stream import Generated
from proxy.core.view.tuning import TUNING as VIEW
from tests.proxy.core.samples.answers import decide_all
from tests.proxy.core.talk import only


@pytest.fixture
def rivals(make_talk, make_specs):
    """Two robots with cameras of 5 Hz that fill the limit twice; the other one's frame was due 5 ms ago."""
    talk = make_talk(make_specs())
    talk.want(0.0)
    talk.tell(ev.InterestChanged(0.0, ("robot/*/camera",)))
    talk.tell(ev.StateHeard(0.0, State("op", "zz-op", "enforce", "", OTHERS, ("robot/*/camera",), number=2)))
    other = talk.core.view.streams.touch(0.0, "op", "robot/op/camera")
    for count in range(1, 41):
        decide_all(talk, 0.2 * count, talk.publish(0.2 * count, size=4000)[1], send=count == 38)
        other.note_generated(count, Generated(0.2 * count - 0.005, 4000, 1.0))
    return talk


OTHERS = (StreamState(1, "robot/op/camera", "camera", 0.2, size=4000, schedule="periodic"),)


def test_a_sample_gives_way_until_it_is_known_what_a_better_claim_had_sent(rivals):
    """The limit has room for one of the two: it goes when the other one was not sent."""
    sample, commands = rivals.publish(8.2, size=4000)
    assert only(rivals.answer(8.2, *only(commands, Decide), send=True)) == []
    again = rivals.tell(ev.TimePassed(8.2 + 1.1 * news_take(rivals.core.view)))
    assert only(rivals.answer(8.25, *only(again, Decide), send=True)) == [Forward(sample)]


def test_a_sample_that_gave_way_is_dropped_when_a_newer_one_is_there(rivals):
    """Which is decided in its place."""
    sample, commands = rivals.publish(8.2, size=4000)
    rivals.publish(8.203, size=4000)
    decided = rivals.answer(8.204, *only(commands, Decide), send=True)
    assert only(decided, Forward, Drop) == [Drop(sample, "dropped:constraint")]


def test_a_sample_does_not_give_way_where_there_is_room_for_both(rivals):
    """Nobody waits where all fits."""
    sample, commands = rivals.publish(8.2, size=100)
    assert only(rivals.answer(8.2, *only(commands, Decide), send=True)) == [Forward(sample)]


def test_in_the_end_a_sample_that_gives_way_is_dropped(rivals):
    """It is too old by then."""
    sample, commands = rivals.publish(8.2, t_gen=7.7, size=4000)
    assert only(rivals.answer(8.2, *only(commands, Decide), send=True)) == [Drop(sample, "dropped:constraint")]


@pytest.mark.parametrize("says", [True, False])
def test_a_large_sample_waits_for_what_somebody_who_was_just_met_sent_lately(make_talk, says):
    """Not for long, where it says nothing; what is small goes at once."""
    talk = make_talk()
    talk.want(0.0)
    talk.tell(ev.TimePassed(5.0))
    talk.tell(ev.PeerAppeared(5.0, "r2", "z-r2"))
    large, commands = talk.publish(5.1, size=3000)
    assert only(commands) == []
    assert talk.core.wake_at(5.1) <= 5.0 + VIEW.greeting_time
    small, commands = talk.publish(5.11, size=10, key="robot/x/camera")
    assert only(commands) == [Forward(small)]
    if says:
        commands = talk.tell(ev.StateHeard(5.13, State("r2", "z-r2", "enforce", "")))
    else:
        assert only(talk.tell(ev.TimePassed(4.99 + VIEW.greeting_time))) == []
        commands = talk.tell(ev.TimePassed(5.0 + VIEW.greeting_time))
    (decide,) = only(commands)
    assert isinstance(decide, Decide)
    assert only(talk.answer(5.3, decide, send=True)) == [Forward(large)]
