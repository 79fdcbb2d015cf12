"""How copies are decided, as transcripts."""

import pytest

from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward, SendCopy
from proxy.core.model.mode import Mode
from tests.proxy.core.samples.absent import LIMIT, catch_up, to_away
from tests.proxy.core.talk import only


def test_copies_cost_who_was_never_away_nothing(make):
    """Room that is booked for its samples is left to them; all of them are sent, and nothing twice."""
    talk = make(limit=LIMIT, backlog=64)
    talk.vanish(1.0)
    samples, live = catch_up(talk, [30.3 + 0.5 * number for number in range(8)])
    assert (talk.all(Forward), talk.all(Drop)) == ([Forward(sample) for sample in samples], [])
    assert [sample for sample, _ in talk.copies()] == [sample for sample in samples if sample not in live]


def test_a_copy_too_large_to_go_beside_what_is_booked_goes_all_the_same(make):
    """It takes that room where nothing else is in the window; else it would never go."""
    talk = make(limit=LIMIT, backlog=64)
    talk.vanish(1.0)
    large = talk.alarm(1.5, "alarm/b", size=9500)
    _, live = catch_up(talk, [42.0, 47.0, 52.0, 57.0], apart=2.5)
    (copy,) = [place for place, each in enumerate(talk.said) if isinstance(each, SendCopy) and each.sample == large]
    assert copy < talk.said.index(Forward(live[-1]))


def test_copies_count_against_the_limit(make):
    """10 kB per second carry nine of 1 kB; the others wait until there is room, and go in order."""
    talk = make(limit=LIMIT)
    talk.vanish(1.0)
    samples = []
    for number in range(20):
        samples.append(talk.alarm(2.0 * number + 2.0, size=1000, priority=5))
        talk.settle(2.0 * number + 2.0, send=True)
    sent, now = [], 50.0
    said = talk.arrive(now)
    while len(sent) < 20 and now < 60.0:
        sent += [(now, sample) for sample, _ in talk.copies(said)]
        decided = only(said, Decide)
        now += 0.0 if decided else 0.05
        said = talk.settle(now, send=True) if decided else talk.tell(ev.TimePassed(now))
    assert [sample for _, sample in sent] == samples
    assert all(sum(1 for at, _ in sent if t - 1.0 < at <= t) <= 10 for t, _ in sent)


def test_a_plan_against_a_copy_is_not_the_last_word(make):
    """There may be more room later, as long as it is worth anything."""
    talk = make(limit=LIMIT, horizon=10)
    for number in range(60):  # a camera that takes more than there is
        _, said = talk.publish(0.1 * number, "camera/a", size=5000)
        for decide in only(said, Decide):
            talk.answer(0.1 * number, decide, send=True)
    talk.vanish(6.0)
    sample, said = talk.publish(6.1, "alarm/a", size=500)
    for decide in only(said, Decide):
        talk.answer(6.1, decide, send=False)
    for decide in only(talk.tell(ev.TimePassed(6.9)), Decide):  # a camera's that waited for room
        talk.answer(6.9, decide, send=False)
    said, now = talk.arrive(7.0), 7.0
    answers = iter([False, True])
    while not talk.copies(said):
        (decide,) = only(said, Decide) or (None,)
        now += 0.1
        said = talk.answer(now, decide, send=next(answers)) if decide else talk.tell(ev.TimePassed(now))
    assert talk.copies(said) == to_away(sample)
    assert next(answers, None) is None


def test_of_once_a_robot_gets_one_and_only_if_it_had_none(make):
    """As if it had been there."""
    talk = make("once", horizon=5)
    talk.alarm(1.0, "alarm/old")
    talk.vanish(20.0)
    talk.alarm(21.0, "alarm/old")
    first = talk.alarm(22.0, "alarm/new")
    talk.alarm(23.0, "alarm/new")
    assert talk.copies(talk.arrive(24.0)) == to_away(first)
    assert talk.kept["by_reason"] == {"dropped:once": 1}
    stream = talk.core.view.streams.known("r1", "alarm/old")
    assert talk.core.view.subscribers.gaining(stream) == ()


@pytest.mark.parametrize("mode", [Mode.SHADOW, Mode.PASS])
def test_where_decisions_are_not_enforced_copies_go_at_once(make, mode):
    """As everything does."""
    talk = make(limit=LIMIT)
    talk.vanish(10.0)
    samples = [talk.alarm(11.0 + number, size=6000) for number in range(3)]
    talk.tell(ev.ModeChanged(15.0, mode))
    talk.settle(15.0)
    assert talk.copies(talk.arrive(16.0)) == to_away(*samples)


@pytest.mark.parametrize("late", [False, True], ids=["fails", "is late"])
def test_while_the_planner_fails_a_copy_goes_where_there_is_room_to_spare(make, late):
    """The static rule holds for it too; it is a copy, and the sample itself is not counted twice."""

    def unanswered(now, decide):
        failed = ev.DecisionReady(now, decide.ticket, None, "broken")
        return talk.tell(ev.DecisionLate(now, decide.ticket) if late else failed)

    talk = make(limit=LIMIT, horizon=10)
    for number in range(60):
        _, said = talk.publish(0.1 * number, "camera/a", size=5000)
        for decide in only(said, Decide):
            talk.answer(0.1 * number, decide, send=True)
    talk.vanish(6.0)
    sample, said = talk.publish(6.1, "alarm/a", size=500, priority=1)
    for decide in only(said, Decide):
        said += unanswered(6.1, decide)
    for command in only(said, Forward):
        talk.tell(ev.SampleHanded(6.1, command.sample))
    (decide,) = only(talk.arrive(8.0), Decide)
    said = unanswered(8.1, decide)
    assert (talk.copies(said), only(said, Forward)) == (to_away(sample), [])
    assert talk.core.counts.conserved
