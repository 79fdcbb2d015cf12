"""Copies, as they are bounded and accounted for."""

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from planner import Plan
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Forget, Forward, Keep, SendCopy
from proxy.core.protocol.messages import State, tag
from proxy.core.samples.tuning import TUNING
from tests.proxy.core.samples.absent import KEYS, LIMIT, OTHER, ZID, to_away


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
