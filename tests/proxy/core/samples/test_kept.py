"""Robots that are away, and what is kept for them, as transcripts, and what must hold of it whatever happens."""

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Forget, Forward, Keep, Retain
from proxy.core.model.waiting import Waiting
from proxy.core.protocol.messages import State, tag
from proxy.core.samples.away import Leaving
from proxy.core.samples.kept import Kept
from tests.proxy.core.samples.absent import KEYS, LIMIT, OTHER, ZID, catch_up, to_away
from tests.proxy.core.talk import only


def test_what_is_published_while_a_robot_is_away_goes_to_it_alone_when_it_is_back(make):
    """The oldest first; the others, who had it at once, get nothing twice, and each sample is counted as it was."""
    talk = make()
    talk.vanish(10.0)
    samples = [talk.alarm(10.0 + number) for number in range(3)]
    assert only(talk.said, Forward) == [Forward(sample) for sample in samples]
    assert talk.kept["for"] == [{"robot": "away", "back": False, "away": -10.0, "samples": 3}]
    assert talk.copies(talk.arrive(14.0)) == to_away(*samples)
    for sample in samples:
        talk.tell(ev.CopyHanded(14.1, sample, tag(ZID)))
    assert (talk.kept["by_reason"], talk.kept["waiting"], talk.kept["for"]) == ({"forwarded": 3}, 0, [])
    assert talk.core.counts.by_reason == {"forwarded": 3}
    assert talk.core.counts.conserved
    assert talk.core.kept.copies.conserved


def test_of_what_a_newer_sample_supersedes_nothing_is_kept(make):
    """A camera's next image tells all."""
    talk = make()
    talk.vanish(10.0)
    talk.alarm(11.0, "camera/a")
    assert talk.copies(talk.arrive(12.0)) == []
    assert talk.all(Keep) == []


def test_what_is_undecided_when_a_robot_vanishes_is_kept_for_it(make):
    """What becomes of it for the others is another question."""
    talk = make(limit=LIMIT)
    first, commands = talk.publish(1.0, "alarm/a", size=6000)
    second, _ = talk.publish(1.1, "alarm/a", size=6000)
    talk.vanish(1.2)
    for decide in only(commands, Decide):
        talk.answer(1.3, decide, send=False)
    assert talk.kept["in"] == 2
    assert {sample for sample, _ in talk.copies(talk.arrive(30.0))} <= {first, second}


def test_what_there_is_no_room_for_beside_copies_is_one_more(make):
    """In its turn: the robot gets all, in order, though it was back when the last one was published."""
    talk = make(limit=LIMIT, backlog=64)
    talk.vanish(1.0, "here", OTHER)
    talk.arrive(1.0, "here", OTHER, KEYS[1:])
    talk.vanish(1.0)
    samples, _ = catch_up(talk, [30.3], [ev.SampleHeard(30.3, "camera/x", 9900, "zz-unknown", None, {})])
    assert [sample for sample, _ in talk.copies()] == samples


def test_a_sample_that_waits_for_its_decision_until_the_robot_is_back_is_kept_once():
    """Though there is no room for it then either: it was sent twice, in the room of others."""
    kept = Kept(100.0)
    kept.lost(0.0, Leaving("away", tag(ZID), KEYS, frozenset(), alike=True))
    for number in (1, 2):
        kept.published(Waiting(number, "alarm/a", 1_000, 0.1, 1.0, 5, False), 60.0, 64, delete=False)
    kept.appeared("away", tag(ZID))
    kept.subscribed(tag(ZID), KEYS)
    kept.published(Waiting(3, "alarm/a", 1_000, 0.2, 1.0, 5, False), 60.0, 64, delete=False)
    for number in (1, 2, 3):
        kept.decided(0.3, number, (tag(ZID),), sent=False)
    assert (kept.copies.entered, kept.copies.waiting) == (3, 3)


def test_a_sample_that_is_gone_before_it_was_decided_is_not_kept():
    """Its payload is lost while it is to be read again: robots that vanished later were kept a copy of nothing."""
    kept = Kept(100.0)
    kept.published(Waiting(1, "alarm/a", 1_000, 0.1, 1.0, 5, False), 60.0, 64, delete=False)
    kept.refused("alarm/a", 1)
    kept.lost(0.2, Leaving("away", tag(ZID), KEYS, frozenset(), alike=True))
    assert (kept.key_of(1), kept.copies.entered, kept.copies.waiting) == (None, 0, 0)


def test_what_is_worth_nothing_any_more_is_given_up(make):
    """After the lifetime of 60 s, with a reason."""
    talk = make()
    talk.vanish(10.0)
    talk.alarm(11.0)
    young = talk.alarm(50.0)
    talk.tell(ev.TimePassed(72.0))
    assert talk.kept["by_reason"] == {"dropped:expired": 1}
    assert talk.copies(talk.arrive(75.0)) == to_away(young)


def test_who_is_away_for_too_long_is_gone(make):
    """What was kept for it is given up, and its payloads are forgotten."""
    talk = make()
    talk.vanish(10.0)
    sample = talk.alarm(65.0)
    talk.tell(ev.TimePassed(111.0))
    assert (talk.kept["by_reason"], talk.kept["for"]) == ({"dropped:gone": 1}, [])
    assert Forget(sample) in talk.said
    assert talk.copies(talk.arrive(112.0)) == []


def test_another_session_of_its_name_means_that_the_first_one_is_gone(make):
    """A daemon that was started anew is another one: what it received before nobody knows."""
    talk = make()
    talk.vanish(10.0)
    talk.alarm(11.0)
    talk.arrive(12.0, zid="xx-anew00")
    assert (talk.kept["by_reason"], talk.copies()) == ({"dropped:gone": 1}, [])


def test_what_a_robot_does_not_want_any_more_is_given_up(make):
    """It says so when it is back."""
    talk = make(limit=LIMIT)
    talk.vanish(10.0)
    talk.alarm(11.0)
    for _ in range(20):  # there is no room for it when it is back
        talk.tell(ev.SamplesPassed(12.0, "passed:no-spec", 1, 1000))
    assert talk.copies(talk.arrive(12.0, keys=("camera/*",))) == []
    assert talk.kept["by_reason"] == {"dropped:unwanted": 1}


def test_until_a_robot_says_what_it_wants_samples_are_kept_for_it(make):
    """Nobody knows yet whether they reach it the ordinary way; what was kept goes at once, before anything new."""
    talk = make()
    talk.vanish(10.0)
    first = talk.alarm(10.5)
    assert talk.copies(talk.tell(ev.PeerAppeared(11.0, "away", ZID))) == to_away(first)
    second = talk.alarm(11.1)
    state = State("away", ZID, "enforce", talk.specs.generation, (), KEYS)
    talk.tell(ev.StateHeard(11.2, state))
    talk.alarm(11.3)
    assert talk.copies() == to_away(first, second)


def test_apps_are_asked_for_what_only_an_absent_robot_wants(make):
    """From the start, so that nothing is missed when it vanishes; for what is kept alone, and no longer than it is."""
    talk = make()
    assert talk.all(Retain) == [Retain(("alarm/*",))]
    talk.vanish(10.0)
    talk.vanish(10.0, "here", OTHER)
    assert len(talk.all(Retain)) == 1
    talk.tell(ev.TimePassed(111.0))
    assert talk.all(Retain)[1:] == [Retain(())]


def test_a_driver_that_cannot_keep_samples_is_not_asked_to(make):
    """A simulation, a replay."""
    talk = make(away=0.0)
    talk.alarm(1.0)
    talk.vanish(1.5)
    talk.alarm(2.0)
    assert (talk.copies(talk.arrive(3.0)), talk.all(Keep), talk.all(Retain)) == ([], [], [])


@settings(
    max_examples=settings().max_examples // 3,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
    deadline=None,
)
@given(steps=st.lists(st.tuples(st.integers(0, 3), st.integers(0, 5), st.integers(0, 5)), min_size=1, max_size=6))
def test_a_robot_gets_each_once_in_order_however_often_it_is_away(make, steps):
    """A link falls, which is noticed up to 4 s later, and comes back; who receives leaves out what it has."""
    talk, now, up, received, published = make(backlog=64), 1.0, True, [], []

    def publish(count):
        nonlocal now
        for _ in range(count):
            now += 0.5
            published.append(talk.alarm(now))
            received.extend([published[-1]] * up)

    for before, unnoticed, away in steps:
        publish(before)
        up = False
        publish(unnoticed)
        now += 1.0
        talk.vanish(now)
        publish(away)
        up = True
        now += 1.0
        for sample, to in talk.copies(talk.arrive(now)):
            received.extend([sample] * (sample not in received))
            talk.tell(ev.CopyHanded(now, sample, to))
    assert received == published
    assert (talk.kept["waiting"], talk.core.kept.copies.conserved) == (0, True)
