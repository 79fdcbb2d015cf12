"""Samples that wait for room, or for news of what others sent, as transcripts."""

from dataclasses import replace
from itertools import pairwise

import pytest

from proxy.core.coordination.claims import news_take
from proxy.core.coordination.tuning import TUNING
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward
from proxy.core.market.standing import Standing
from proxy.core.protocol.messages import Digest, State, StreamState, tag
from proxy.core.protocol.state_codec import pack_state
from proxy.core.transit.latency import Latency
from proxy.core.view.stream import Generated, Sent
from proxy.core.view.tuning import TUNING as VIEW
from tests.proxy.core.samples.answers import decide_all
from tests.proxy.core.talk import SPEC, only


@pytest.fixture
def rivals(make_talk, make_specs):
    """Two robots with cameras of 5 Hz that fill the limit twice; the other one's frame was due 5 ms ago."""
    return meet(make_talk(make_specs()))


@pytest.fixture
def counted(make_aggregated):
    """The same two, where each frame counts."""
    return meet(make_aggregated("sum"))


def meet(talk):
    """Let the other robot be heard of."""
    talk.want(0.0)
    talk.tell(ev.InterestChanged(0.0, ("robot/*/camera",)))
    talk.tell(ev.StateHeard(0.0, State("op", "zz-op", "enforce", "", OTHERS, ("robot/*/camera",), number=2)))
    other = talk.core.view.streams.touch(0.0, "op", "robot/op/camera")
    for count in range(1, 41):
        decide_all(talk, 0.2 * count, talk.publish(0.2 * count, size=4000)[1], send=count == 38)
        other.note_generated(count, Generated(0.2 * count - 0.005, 4000, 1.0))
    return talk


ALARM = """
[[information_type]]
name = "alarm"
keys = ["robot/*/alarm"]
aggregation = "sum"
weight = 50
utility = { kind = "step", lifetime = "10 s" }
"""
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


@pytest.fixture
def slow(rivals):
    """The same two, when a frame takes 0.4 s, as the other robot tells, and there is room for both."""
    rivals.core.view.peers["zz-op"].outbound.latency = Latency(0.01, 1e-4)
    limit = replace(rivals.core.budget.limits[0], limit=20_000.0, window=2.0)
    rivals.core.budget.set_limits((limit,))
    return rivals


def announce(talk, at, size=4000):
    """The other robot has sent a frame."""
    other = talk.core.view.streams.known("op", "robot/op/camera")
    talk.core.view.traffic.note_sent(other, other.forwarded + 1, Sent(at, at, size, 1.0))


def test_an_alarm_that_is_not_small_waits_for_room_that_others_leave_for_as_long_as_it_is_worth_anything(
    make_talk, make_specs
):
    """Another robot fills one window after the other: it was dropped at once, as our own sends left it none."""
    talk = meet(make_talk(make_specs(text=SPEC.format(limit="80 kbit/s", window=1.0) + ALARM)))
    talk.tell(ev.StateHeard(8.0, State("op", "zz-op", "enforce", "", OTHERS, ("robot/**",), number=3)))
    other, done = talk.core.view.streams.known("op", "robot/op/camera"), []

    def decide(now, commands):
        """All alarms are sent, and no frame."""
        done.extend(only(commands, Forward, Drop))
        while decides := only(commands, Decide):
            commands = talk.answer(now, decides[0], send=talk.core.gate.search.pending.sample.sample in alarms)
            done.extend(only(commands, Forward, Drop))

    alarms = []
    for count in range(41, 105):
        now = 0.2 * count
        other.note_generated(count, Generated(now - 0.005, 4000, 1.0))
        if count >= 90 and count % 5 == 0 and count < 100:
            announce(talk, now, size=9500)
        decide(now, talk.publish(now, size=4000)[1])
        if count in {43, 48, 51, 60, 62, 71, 77, 85, 91}:
            sample, commands = talk.publish(now + 0.01, key="robot/r1/alarm", size=600)
            alarms.append(sample)
            decide(now + 0.02, commands)
    stream = talk.core.view.streams.known("r1", "robot/r1/alarm")
    assert talk.core.gate.appraisal.disputes.weighed(stream).standing is Standing.CONTESTED
    assert [each for each in done if each.sample == alarms[-1]] == [Forward(alarms[-1])]


def test_a_large_sample_waits_until_the_channel_has_carried_what_another_robot_sent(slow):
    """A frame of 4 kB takes 0.32 s at four fifths of the pace of the limit; the newest one is decided then."""
    announce(slow, 8.15)
    first, commands = slow.publish(8.2, size=4000)
    assert only(commands) == []
    second, commands = slow.publish(8.4, size=4000)
    assert only(commands, Decide, Drop) == [Drop(first, "dropped:superseded")]
    assert slow.core.wake_at(8.4) > 8.4
    free = 8.15 + 0.32 + news_take(slow.core.view)
    (decide,) = only(slow.tell(ev.TimePassed(free + 0.001)))
    assert isinstance(decide, Decide)
    assert only(slow.answer(free + 0.002, decide, send=True)) == [Forward(second)]


def test_a_sample_that_is_to_be_sent_waits_when_another_robot_sent_while_it_was_decided(slow):
    """The channel has to carry that first."""
    _, commands = slow.publish(8.2, size=4000)
    (decide,) = only(commands)
    announce(slow, 8.2)
    assert only(slow.answer(8.205, decide, send=True)) == []
    assert only(slow.tell(ev.TimePassed(8.3))) == []


def test_a_sample_that_its_price_sends_waits_for_the_channel_too(slow):
    """Where a window holds many frames none is searched for; two still come late that are sent at one moment."""
    limit = replace(slow.core.budget.limits[0], limit=100_000.0, window=4.0)
    slow.core.budget.set_limits((limit,))
    announce(slow, 8.15)
    sample, commands = slow.publish(8.2, size=4000)
    assert only(commands) == []
    stream = slow.core.view.streams.known("r1", "robot/r1/camera")
    assert slow.core.gate.appraisal.disputes.weighed(stream).standing is Standing.PRICED
    free = 8.15 + 0.8 * 4000 / 25_000
    assert only(slow.tell(ev.TimePassed(free - 0.001))) == []
    assert only(slow.tell(ev.TimePassed(free + 0.001))) == [Forward(sample)]


def test_nobody_waits_where_the_channel_is_fast(slow):
    """However slow the limit is."""
    slow.core.view.peers["zz-op"].outbound.latency = Latency(0.0, 1e-9)
    announce(slow, 8.19)
    _, commands = slow.publish(8.2, size=4000)
    assert isinstance(only(commands)[0], Decide)


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


def test_a_sample_does_not_overtake_one_of_its_key_that_gave_way(counted):
    """Where each counts: it is decided behind it, however it stands itself."""
    first, commands = counted.publish(8.2, size=4000)
    assert only(counted.answer(8.2, *only(commands, Decide), send=True)) == []
    second, commands = counted.publish(8.201, size=100)
    assert only(commands) == []
    commands = counted.tell(ev.TimePassed(8.2 + 1.1 * news_take(counted.core.view)))
    assert decide_all(counted, 8.25, commands, send=True) == [Forward(first), Forward(second)]


def test_a_sample_that_counts_gives_way_though_a_newer_one_waits(counted):
    """That replaces it only where the latest counts: it was dropped, and the newer one sent."""
    first, (decide,) = counted.publish(8.2, size=4000)
    second, commands = counted.publish(8.2005, size=100)
    assert only(commands) == []
    assert only(counted.answer(8.201, decide, send=True)) == []
    commands = counted.tell(ev.TimePassed(8.201 + 1.1 * news_take(counted.core.view)))
    assert decide_all(counted, 8.25, commands, send=True) == [Forward(first), Forward(second)]


def test_where_news_take_seconds_no_sample_that_counts_waits_longer_than_its_patience(counted):
    """As after a freeze: it is decided when it has waited for as long as the window of the limit."""
    limit = replace(counted.core.budget.limits[0], limit=20_000.0, window=2.0)
    counted.core.budget.set_limits((limit,))
    counted.core.view.peers["zz-op"].outbound.latency = Latency(0.01, 1e-4)
    counted.core.view.staleness.delay = 5.0
    decide_all(counted, 8.1, counted.publish(8.1, size=4000)[1], send=True)
    counted.core.view.streams.known("op", "robot/op/camera").note_generated(41, Generated(8.12, 4000, 3.0))
    announce(counted, 8.15)
    sample, commands = counted.publish(8.2, size=4000)
    assert only(commands) == []
    assert only(counted.tell(ev.TimePassed(10.19))) == []
    commands = counted.tell(ev.TimePassed(10.21))
    assert decide_all(counted, 10.21, commands, send=True) == [Forward(sample)]


def test_a_small_sample_waits_a_window_at_most_for_what_others_claim(counted):
    """It has a part for certain. Where windows were stretched for a gigabyte that another sent it was dropped."""
    core = counted.core
    other = core.view.streams.known("op", "robot/op/camera")
    other.note_generated(41, Generated(8.195, 4000, 1.0))
    core.view.traffic.note_sent(other, other.forwarded + 1, Sent(8.1, 8.1, 1 << 30, 1.0))
    core.budget.stretch.weigh(core.budget.limits, (0.0,), [((1e9,), (0.0,))])
    sample, commands = counted.publish(8.2, size=20)
    assert only(commands, Decide, Drop, Forward) == []
    assert only(counted.tell(ev.TimePassed(9.201)), Decide, Drop, Forward) == [Forward(sample)]


def test_a_small_sample_that_counts_waits_for_its_part_where_nothing_else_is_left(counted):
    """A window that is stretched has room in all, and none in its last part: the sample was dropped at once."""
    core = counted.core
    other = core.view.streams.known("op", "robot/op/camera")
    other.note_generated(41, Generated(8.195, 4000, 1.0))
    core.view.traffic.note_sent(other, other.forwarded + 1, Sent(7.9, 7.9, 30_000, 1.0))
    core.budget.stretch.weigh(core.budget.limits, (0.0,), [((30_000.0,), (0.0,))])
    core.budget.use(8.1, (9_990.0,))
    sample, commands = counted.publish(8.2, size=20)
    assert only(commands, Decide, Drop, Forward) == []
    assert only(counted.tell(ev.TimePassed(9.101)), Decide, Drop, Forward) == [Forward(sample)]


MANY = """
[[constraint]]
kind = "throughput"
limit = "80 kbit/s"
window = 1.0
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
weight = 10
utility = {{ kind = "step", lifetime = "60 s" }}
[[information_type]]
name = "map"
keys = ["robot/*/map"]
utility = {{ kind = "step", lifetime = "60 s" }}
{guarantee}
"""
FRAME = 4_000


@pytest.fixture
def make_talk_of_many(make_talk, make_specs):
    """A robot of a large team whose others have cameras; one of them finds that limits have to be split."""

    def make(guarantee):
        talk = make_talk(make_specs(text=MANY.format(guarantee=guarantee)), allowance=0.02)
        talk.want(0.0, keys=("robot/**",))
        for name in (f"x{number}" for number in range(TUNING.large_team)):
            camera = StreamState(1, f"robot/{name}/camera", "camera", 1.0, size=FRAME, schedule="periodic")
            talk.tell(ev.PeerAppeared(0.0, name, f"z-{name}"))
            state = State(name, f"z-{name}", "enforce", "", (camera,), (), number=1)
            talk.tell(ev.StateHeard(0.0, state, len(pack_state(state))))
        vote = Digest("x0", tag("z-x0"), 0.1, 0, 0, state=1, splits=True)
        talk.tell(ev.DigestHeard(0.1, vote, 40))
        return talk

    return make


def sent(talk, turns):
    """Publish a map and an image once a second for so many turns; return which went when [s]."""
    kinds, found = dict[int, str](), list[tuple[float, str]]()
    for step in range(10, 100 * 100):
        now = 0.01 * step
        said = talk.tell(ev.TimePassed(now))
        if step % 100 == 0:
            for kind in ("map", "camera"):
                sample, more = talk.publish(now, key=f"robot/r1/{kind}", size=FRAME)
                kinds[sample], said = kind, [*said, *more]
        while decides := only(said, Decide):
            found += [(now, kinds[each.sample]) for each in only(said, Forward)]
            said = talk.answer(now, decides[0], send=True)
        found += [(now, kinds[each.sample]) for each in only(said, Forward)]
        if len(found) == turns:
            break
    return found


@pytest.mark.full
@pytest.mark.parametrize(
    ("guarantee", "goes"), [("", ["camera", "camera", "camera"]), ('min_rate = "0.03 Hz"', ["map", "map", "map"])]
)
def test_in_a_turn_that_goes_which_gains_most(make_talk_of_many, guarantee, goes):
    """What is guaranteed first, though both are as old."""
    talk = make_talk_of_many(guarantee)
    found = sent(talk, len(goes))
    assert talk.core.budget.coordination.equal.by_clock
    assert [kind for _, kind in found] == goes
    assert all(later - at > 10.0 for (at, _), (later, _) in pairwise(found))
