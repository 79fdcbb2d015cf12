"""What robots that are back are announced, as transcripts."""

from proxy.core.interface import events as ev
from proxy.core.interface.commands import TellBacklog
from proxy.core.protocol.messages import State, tag
from proxy.core.samples.tuning import TUNING
from tests.proxy.core.samples.absent import KEYS, ZID
from tests.proxy.core.talk import only


def test_a_robot_that_is_back_is_told_of_which_keys_copies_wait(make):
    """Once when it says what it wants, whenever that changes, and now and then; one that was never away, nothing."""
    talk, to = make(), tag(ZID)
    assert talk.all(TellBacklog) == []
    talk.vanish(10.0)
    first, second = talk.alarm(10.0, "alarm/a"), talk.alarm(10.1, "alarm/b")
    assert only(talk.arrive(20.0), TellBacklog) == [TellBacklog(to, 1, ("alarm/a", "alarm/b"), grows=True)]
    assert only(talk.tell(ev.CopyHanded(20.1, first, to)), TellBacklog) == [
        TellBacklog(to, 2, ("alarm/b",), grows=False)
    ]
    assert only(talk.tell(ev.TimePassed(21.5)), TellBacklog) == [TellBacklog(to, 3, ("alarm/b",), grows=True)]
    assert only(talk.tell(ev.CopyHanded(22.0, second, to)), TellBacklog) == [TellBacklog(to, 4, (), grows=False)]
    talk.tell(ev.StateHeard(23.0, State("away", ZID, "enforce", talk.specs.generation, (), KEYS, number=2)))
    assert len(talk.all(TellBacklog)) == 4


def test_a_robot_for_which_nothing_is_kept_is_told_so(make):
    """It waits to hear that; of too many keys no names are told."""
    talk = make(backlog=1)
    talk.vanish(10.0)
    assert only(talk.arrive(11.0), TellBacklog) == [TellBacklog(tag(ZID), 1, (), grows=True)]
    talk.vanish(12.0)
    for number in range(TUNING.named_keys + 1):
        talk.alarm(12.0, f"alarm/{number}")
    (word,) = only(talk.arrive(13.0), TellBacklog)
    assert word == TellBacklog(tag(ZID), 2, None, grows=True)
