"""What was sent shortly before a loss was noticed, as transcripts."""

from proxy.core.interface import events as ev
from proxy.core.protocol.messages import State, tag
from proxy.core.samples.tuning import TUNING
from tests.proxy.core.samples.absent import KEYS, LIMIT, ZID, to_away


def test_what_was_sent_shortly_before_the_loss_was_noticed_is_offered_again(make):
    """Nobody knows whether it arrived; what is older did."""
    talk = make()
    old, young = talk.alarm(1.0), talk.alarm(1.5 + TUNING.doubtful)
    talk.vanish(2.0 + TUNING.doubtful)
    assert talk.copies(talk.arrive(3.0 + TUNING.doubtful)) == to_away(young)
    assert old not in dict(talk.copies())


def test_a_robot_that_has_other_specs_is_sent_nothing_that_it_may_have(make):
    """It would not notice, and its applications would get it twice."""
    talk = make()
    talk.tell(ev.StateHeard(0.1, State("away", ZID, "enforce", "others", (), KEYS, number=2)))
    talk.alarm(1.0)
    talk.vanish(1.5)
    sample = talk.alarm(2.0)
    assert talk.copies(talk.arrive(3.0)) == to_away(sample)


def test_what_there_was_no_room_for_shortly_before_the_loss_was_noticed_is_kept(make):
    """Room is lent by one robot, perhaps by the one that has vanished; what a plan was against is not kept."""
    talk = make(limit=LIMIT, horizon=10)
    talk.tell(ev.SampleHeard(10.9, "camera/x", 9000, "zz-unknown", None, {}))
    for number in range(12):
        talk.alarm(11.0 + 0.01 * number, size=1000)
        talk.settle(11.0 + 0.01 * number, send=number != 3)
    outcomes = talk.core.counts.by_reason
    assert outcomes["dropped:constraint"] > 0
    talk.vanish(12.0)
    assert talk.kept["in"] == 12 - outcomes["dropped:planner"]


def test_a_copy_that_is_lost_with_the_link_again_is_offered_again(make):
    """Handed to the mesh session is not received."""
    talk = make()
    talk.vanish(10.0)
    sample = talk.alarm(11.0)
    assert talk.copies(talk.arrive(12.0)) == to_away(sample)
    talk.tell(ev.CopyHanded(12.1, sample, tag(ZID)))
    talk.vanish(12.5)
    assert talk.copies(talk.arrive(13.0)) == to_away(sample)
    talk.vanish(13.1)  # before it was handed over
    talk.tell(ev.CopyHanded(13.2, sample, tag(ZID)))
    assert talk.copies(talk.arrive(14.0)) == to_away(sample)
    assert talk.core.kept.copies.conserved


def test_a_loss_too_short_to_be_told_is_one(make):
    """A token that appears of a robot that is there had vanished."""
    talk = make()
    sample = talk.alarm(1.0)
    assert talk.copies(talk.tell(ev.PeerAppeared(1.5, "away", ZID))) == to_away(sample)
