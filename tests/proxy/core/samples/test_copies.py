"""Copies, as they are bounded and accounted for."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from planner import Plan
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Forget, Forward, Keep, SendCopy, TellBacklog
from proxy.core.model.waiting import Waiting
from proxy.core.protocol.messages import State, tag
from proxy.core.protocol.state_codec import pack_backlog, unpack_backlog
from proxy.core.samples.copies import HeldPayloads
from proxy.core.samples.tuning import TUNING
from tests.proxy.core.samples.absent import KEYS, LIMIT, OTHER, ZID, to_away
from tests.proxy.core.talk import only


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


@pytest.mark.parametrize("key", ["alarm/*", "alarm/" + "k" * 1019, "alarm/" + "温" * 340])
def test_of_a_key_that_others_do_not_read_copies_wait_without_a_name(make, key):
    """All that waited was unreadable to the robot, so new samples overtook the copies."""
    talk = make()
    talk.vanish(10.0)
    talk.alarm(11.0)
    talk.alarm(12.0, key)
    first, *_ = only(talk.arrive(20.0), TellBacklog)
    assert (first.keys, unpack_backlog(pack_backlog(first.number, first.keys))) == (None, (first.number, None))


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


def waiting(sample, size=100):
    return Waiting(sample, "alarm/a", size, 0.0, 1.0, 5, markovian=False)


def test_a_payload_is_kept_before_what_else_is_commanded_and_forgotten_after_it():
    """So it is there when it is to be sent."""
    payloads = HeldPayloads()
    payloads.hold(waiting(1))
    assert payloads.around([Forward(1)]) == [Keep(1), Forward(1)]
    payloads.hold(waiting(2))
    payloads.release(1)
    assert payloads.around([Forward(2)]) == [Keep(2), Forward(2), Forget(1)]
    assert payloads.around([]) == []


def test_what_is_needed_for_less_than_an_event_is_never_commanded():
    """The driver has nothing to do with it, nor with what is needed again at once."""
    payloads = HeldPayloads()
    payloads.hold(waiting(1))
    payloads.release(1)
    assert payloads.around([]) == []
    payloads.hold(waiting(2))
    payloads.around([])
    payloads.release(2)
    payloads.hold(waiting(2))
    assert payloads.around([]) == []


@given(st.lists(st.tuples(st.sampled_from(["hold", "release", "command"]), st.integers(0, 3)), max_size=60))
def test_the_driver_keeps_what_somebody_needs(steps):
    """As often as it is needed, and each is counted once in bytes."""
    payloads, needed, kept = HeldPayloads(), dict.fromkeys(range(4), 0), set()
    for step, sample in [*steps, ("command", 0)]:
        if step == "hold":
            payloads.hold(waiting(sample, size=10**sample))
            needed[sample] += 1
        elif step == "release" and needed[sample]:
            payloads.release(sample)
            needed[sample] -= 1
        elif step == "command":
            for command in payloads.around([]):
                (kept.add if isinstance(command, Keep) else kept.remove)(command.sample)
            assert kept == {sample for sample, times in needed.items() if times}
        assert payloads.bytes == sum(10**sample for sample, times in needed.items() if times)


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
    talk.tell(ev.SampleHeard(11.5, "camera/x", 9000, "zz-unknown", None, {}))
    for t in (12.02, 12.05):  # the first ones have waited for a window
        talk.tell(ev.TimePassed(t))
        talk.settle(t)
    outcomes = talk.core.counts.by_reason
    assert outcomes["dropped:constraint"] > 0
    talk.vanish(12.1)
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
