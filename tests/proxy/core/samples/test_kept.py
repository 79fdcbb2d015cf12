"""Copies for robots that are away, as transcripts, and what must hold of them whatever happens."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from planner import Plan
from proxy.core.core import Core
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forget, Forward, Keep, Retain, SendCopy, TellBacklog
from proxy.core.model.mode import Mode
from proxy.core.model.settings import CoreSettings
from proxy.core.model.waiting import Waiting
from proxy.core.protocol.messages import State, tag
from proxy.core.samples.away import Leaving
from proxy.core.samples.kept import Kept
from proxy.core.samples.tuning import TUNING
from tests.proxy.core.talk import Talk, only

SPEC = """
[[information_type]]
name = "alarm"
keys = ["alarm/*"]
aggregation = "{aggregation}"
utility = {{ kind = "step", lifetime = "60 s" }}
[[information_type]]
name = "camera"
keys = ["camera/*"]
utility = {{ kind = "video" }}
"""
LIMIT = """
[[constraint]]
kind = "throughput"
limit = "80 kbit/s"
window = 1.0
"""
ZID, OTHER = "zz-away00", "yy-here00"
KEYS = ("alarm/*", "camera/*")


@pytest.fixture
def make(make_specs):
    """A core of robot r1 with the robots `away` and `here`, that keeps what is missed for up to 100 s."""

    def make(aggregation="sum", limit="", **rest):
        specs = make_specs(text=limit + SPEC.format(aggregation=aggregation))
        rest = {"coordination": "announce", "allowance": 0.0, "away": 100.0} | rest
        talk = Away(Core(CoreSettings("r1", "z-r1", **rest), specs, 0.0))
        talk.specs = specs
        talk.arrive(0.0)
        talk.arrive(0.0, "here", OTHER)
        return talk

    return make


class Away(Talk):
    """Talks to a core of a robot that vanishes and comes back."""

    def arrive(self, now, robot="away", zid=ZID, keys=KEYS):
        said = self.tell(ev.PeerAppeared(now, robot, zid))
        return said + self.tell(ev.StateHeard(now, State(robot, zid, "enforce", self.specs.generation, (), keys)))

    def vanish(self, now, robot="away", zid=ZID):
        return self.tell(ev.PeerGone(now, robot, zid))

    def alarm(self, now, key="alarm/a", **rest):
        """Publish, hand over what is forwarded at once, and return the number."""
        sample, commands = self.publish(now, key, **rest)
        for command in only(commands, Forward):
            self.tell(ev.SampleHanded(now, command.sample))
        return sample

    def settle(self, now, *, send=False):
        """Answer all that is to be decided; return what is commanded then."""
        said = []
        while self.core.gate.search.pending is not None:
            (decide,) = [each for each in self.all(Decide) if each.ticket == self.core.gate.search.pending.ticket]
            said += self.answer(now, decide, send=send)
        return said

    @property
    def kept(self):
        return self.core.status(0.0)["kept"]

    def copies(self, commands=None):
        return [(copy.sample, tag(copy.to)) for copy in only(self.said if commands is None else commands, SendCopy)]


def to_away(*samples):
    return [(sample, tag(ZID)) for sample in samples]


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


def test_of_what_a_newer_sample_supersedes_nothing_is_kept(make):
    """A camera's next image tells all."""
    talk = make()
    talk.vanish(10.0)
    talk.alarm(11.0, "camera/a")
    assert talk.copies(talk.arrive(12.0)) == []
    assert talk.all(Keep) == []


def test_what_was_sent_shortly_before_the_loss_was_noticed_is_offered_again(make):
    """Nobody knows whether it arrived; what is older did."""
    talk = make()
    old, young = talk.alarm(1.0), talk.alarm(1.5 + TUNING.doubtful)
    talk.vanish(2.0 + TUNING.doubtful)
    assert talk.copies(talk.arrive(3.0 + TUNING.doubtful)) == to_away(young)
    assert old not in dict(talk.copies())


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
    talk.tell(ev.SampleHeard(0.9, "camera/x", 9000, "zz-unknown", None, {}))
    for number in range(12):
        talk.alarm(1.0 + 0.01 * number, size=1000)
        talk.settle(1.0 + 0.01 * number, send=number != 3)
    outcomes = talk.core.counts.by_reason
    assert outcomes["dropped:constraint"] > 0
    talk.vanish(2.0)
    assert talk.kept["in"] == 12 - outcomes["dropped:planner"]


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


def catch_up(talk, times, events=(), apart=1.0):
    """Alarms of 1 kB, `apart` [s], while a robot is away, and at `times`, when it gets its copies; all, and the latter.

    Before the first of those there are `events`.
    """
    samples, live = [], []
    for number in range(15):
        samples.append(talk.alarm(2.0 + apart * number, size=1000))
        talk.settle(2.0 + apart * number, send=True)
    now, due = max(30.0, 3.0 + apart * number), list(times)
    said = talk.arrive(now)
    while talk.kept["waiting"] or talk.core.gate.undecided.inbox or due:
        while due and due[0] <= now:
            for event in () if live else events:
                talk.tell(event)
            live.append(talk.alarm(due.pop(0), size=1000))
        for sample, to in talk.copies(said):
            talk.tell(ev.CopyHanded(now, sample, to))
        now += 0.05
        assert now < 99.0
        said = talk.tell(ev.TimePassed(now)) + talk.settle(now, send=True)
    return [*samples, *live], live


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


def test_of_a_stream_no_more_is_kept_than_may_wait(make):
    """The least valuable leaves, of equals the oldest."""
    talk = make(backlog=3)
    talk.vanish(10.0)
    samples = [talk.alarm(10.0 + number) for number in range(5)]
    assert talk.kept["by_reason"] == {"dropped:overflow": 2}
    assert talk.copies(talk.arrive(20.0)) == to_away(*samples[2:])


def test_what_is_kept_is_bounded_in_bytes_and_robots(make):
    """Whoever left first is gone."""
    talk = make(backlog=256)
    talk.vanish(10.0)
    for number in range(40):
        talk.alarm(11.0, f"alarm/{number}", size=TUNING.payload_bytes // 32)
    assert talk.kept["bytes"] <= TUNING.payload_bytes
    assert talk.kept["by_reason"] == {"dropped:overflow": 8}
    for number in range(TUNING.robots):
        talk.arrive(20.0, f"r{number}", f"{number:08d}")
        talk.vanish(21.0, f"r{number}", f"{number:08d}")
    assert len(talk.kept["for"]) == TUNING.robots
    assert "away" not in {each["robot"] for each in talk.kept["for"]}


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
    stream = talk.core.view.known("r1", "alarm/old")
    assert talk.core.view.gaining(stream) == ()


def test_of_best_the_best_is_kept(make):
    """What else there was is worth nothing beside it."""
    talk = make("best")
    talk.vanish(10.0)
    for number in range(3):
        sample = talk.alarm(11.0 + number)
    assert talk.copies(talk.arrive(15.0)) == to_away(sample)


def test_a_deletion_keeps_its_place_among_the_copies(make):
    """Whoever was away has nothing left of what was deleted meanwhile."""
    talk = make()
    talk.vanish(10.0)
    samples = [talk.alarm(11.0), talk.alarm(12.0, delete=True), talk.alarm(13.0)]
    assert talk.copies(talk.arrive(14.0)) == to_away(*samples)


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


EVENTS = st.lists(
    st.tuples(
        st.sampled_from(("alarm/a", "alarm/b", "vanish", "arrive", "hand", "refuse", "wait", "delete")),
        st.sampled_from((ZID, OTHER)),
        st.sampled_from((0.1, 1.0, 7.0, 40.0)),
    ),
    max_size=60,
)


@settings(
    max_examples=settings().max_examples // 3,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
    deadline=None,
)
@given(events=EVENTS, limit=st.sampled_from(("", LIMIT)), aggregation=st.sampled_from(("sum", "once", "best")))
def test_whatever_happens_copies_are_bounded_and_accounted_for(make, events, limit, aggregation):
    """Whatever waits has its payload, and in the end no payload is kept for nobody."""
    talk = make(aggregation, limit, backlog=4)
    world = World(talk)
    for what, zid, seconds in events:
        world.happen(what, zid, seconds)
        assert talk.core.kept.copies.conserved
        assert talk.core.counts.conserved
        assert talk.kept["bytes"] == sum(world.sizes[sample] for sample in world.payloads)
        assert talk.kept["waiting"] <= 2 * 2 * (4 + 1) + len(world.handing)
    for zid in (ZID, OTHER):
        world.happen("vanish", zid, 1.0)
    world.happen("wait", ZID, 200.0)
    assert not world.payloads
    assert talk.kept["waiting"] == 0


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


class World:
    """Two robots that vanish and come back, and a driver that keeps payloads and hands over copies sooner or later."""

    def __init__(self, talk):
        self.talk = talk
        self.now = 1.0
        self.there = {ZID: True, OTHER: True}
        self.payloads, self.handing, self.sizes = set(), [], {}

    def happen(self, what, zid, seconds):
        self.now += seconds
        name = {ZID: "away", OTHER: "here"}[zid]
        if what.startswith("alarm") or what == "delete":
            key = "alarm/a" if what == "delete" else what
            self.talk.samples += 1
            number = self.talk.samples
            self.sizes[number] = 1000
            self.feed(ev.SamplePublished(self.now, number, key, 1000, self.now, None, 5, {}, delete=what == "delete"))
        elif what == "vanish" and self.there[zid]:
            self.there[zid] = False
            self.feed(ev.PeerGone(self.now, name, zid))
        elif what == "arrive" and not self.there[zid]:
            self.there[zid] = True
            self.feed(ev.PeerAppeared(self.now, name, zid))
            state = State(name, zid, "enforce", self.talk.specs.generation, (), KEYS)
            self.feed(ev.StateHeard(self.now, state))
        elif what in {"hand", "refuse"} and self.handing:
            copy = self.handing.pop(0)
            answer = ev.CopyHanded if what == "hand" else ev.CopyRefused
            self.feed(answer(self.now, copy.sample, copy.to))
        else:
            self.feed(ev.TimePassed(self.now))

    def feed(self, event):
        """Tell the core; what it is told in answer comes after all that it commands."""
        answers = []
        for command in self.talk.tell(event):
            match command:
                case Keep(sample):
                    assert sample not in self.payloads
                    self.payloads.add(sample)
                case Forget(sample):
                    self.payloads.remove(sample)
                case SendCopy(sample, to):
                    assert sample in self.payloads
                    assert self.there[ZID if to == tag(ZID) else OTHER]
                    self.handing.append(command)
                case Forward(sample):
                    answers.append(ev.SampleHanded(self.now, sample))
                case Decide(ticket, problem):
                    sends = (problem.current,) if ticket % 3 else ()
                    answers.append(ev.DecisionReady(self.now, ticket, Plan(bool(sends), sends, 1.0, None, 1, 1)))
        for answer in answers:
            self.feed(answer)
