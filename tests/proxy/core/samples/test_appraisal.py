"""What a sample is as things are now, at a core that talks."""

import math

import pytest

from proxy.core.coordination.budget import Budget
from proxy.core.coordination.coordination import Coordination
from proxy.core.market.disputes import Disputes
from proxy.core.market.standing import Standing
from proxy.core.model.limits import limits_of
from proxy.core.model.mode import Mode
from proxy.core.model.settings import CoreSettings
from proxy.core.model.waiting import Waiting
from proxy.core.samples.appraisal import Appraisal
from proxy.core.view.stream import Generated, Sent
from proxy.core.view.view import SharedView
from tests.proxy.core.talk import SPEC, UNLIMITED

CAMERA, SMALL, OTHERS = "robot/r1/camera", "robot/r1b/camera", "robot/r2/camera"
SIZE = 1_000


def waiting(key=CAMERA, size=SIZE, t_gen=5.0):
    return Waiting(0, key, size, t_gen, 1.0, 5, markovian=True)


def appraisal(talk):
    return talk.core.gate.appraisal


def filmed(talk, count, *, begin=0.0, apart=0.5, key=CAMERA, size=SIZE):
    """So many samples are published; return their stream."""
    for number in range(count):
        talk.publish(begin + apart * number, key, size=size)
    return talk.core.view.streams.known("r1", key)


@pytest.fixture
def talk(make_talk):
    """A core whose cameras robot op wants: they may take 10 kB/s."""
    made = make_talk()
    made.want(0.0)
    return made


def test_a_type_decides_for_itself_at_most_what_the_daemon_does(make_talk, make_specs):
    """Where no spec plans for a key, or its type says nothing, the daemon's mode holds."""
    shadowed = SPEC.format(limit="80 kbit/s", window=1.0).replace("weight = 1.0", 'mode = "shadow"')
    for text, mode in ((shadowed, Mode.SHADOW), (None, Mode.ENFORCE)):
        talk = make_talk(make_specs(text=text))
        talk.want(0.0)
        stream = filmed(talk, 1)
        assert (appraisal(talk).mode_of(stream), appraisal(talk).mode_of(None)) == (mode, Mode.ENFORCE)
        appraisal(talk).set_mode(Mode.PASS)
        assert (appraisal(talk).mode_of(stream), appraisal(talk).mode_of(None)) == (Mode.PASS, Mode.PASS)


def test_whose_sample_waits_stays_in_the_view(make_talk):
    """However many streams came since."""
    talk = make_talk(streams=2)
    talk.want(0.0)
    stream = filmed(talk, 1)
    filmed(talk, 1, begin=1.0, key="robot/r1b/camera")
    assert appraisal(talk).stream_of(2.0, waiting()) is stream
    filmed(talk, 1, begin=3.0, key="robot/r1c/camera")
    assert appraisal(talk).stream_of(4.0, waiting()) is stream
    assert talk.core.view.streams.known("r1", "robot/r1b/camera") is None
    assert appraisal(talk).stream_of(4.0, waiting("no/spec")) is None


def test_each_robot_that_wants_a_sample_costs_a_copy(talk):
    """Of what no spec plans for nobody knows who wants it: it counts once."""
    stream = filmed(talk, 1)
    assert appraisal(talk).use(stream, waiting()) == (SIZE,)
    talk.want(0.1, "op2", "zz-op2")
    assert appraisal(talk).use(stream, waiting()) == (2 * SIZE,)
    assert appraisal(talk).use(None, waiting("no/spec")) == (SIZE,)


def test_a_sample_is_owed_when_the_next_one_would_come_too_late(make_talk, make_specs):
    """By what the spec guarantees; without a guarantee none is."""
    text = SPEC.format(limit="80 kbit/s", window=1.0).replace("weight = 1.0", 'min_rate = "0.5 Hz"')
    talk = make_talk(make_specs(text=text))
    talk.want(-10.0)
    stream = filmed(talk, 10, begin=-9.0)
    sent = stream.sent.t_gen
    assert not appraisal(talk).owed(sent + 1.0, stream, waiting(t_gen=sent + 1.0))
    assert appraisal(talk).owed(sent + 2.0, stream, waiting(t_gen=sent + 2.0))
    plain = make_talk()
    plain.want(-10.0)
    assert not appraisal(plain).owed(9.0, filmed(plain, 10, begin=-9.0), waiting(t_gen=9.0))


def test_there_is_room_for_all_while_all_that_competes_fits(talk):
    """A stream of a tenth of the limit does; a second one of nine tenths does not beside it."""
    stream = filmed(talk, 20, begin=1.0, apart=1.0)
    assert appraisal(talk).look_for_room(20.1, stream, waiting=0)
    for number in range(20):
        large = filmed(talk, 1, begin=20.5 + number, key="robot/r1b/camera", size=9 * SIZE)
        filmed(talk, 1, begin=21.0 + number)
    appraisal(talk).published(40.1, large)
    assert not appraisal(talk).look_for_room(40.1, stream, waiting=0)


def test_without_a_limit_there_is_always_room(make_talk, make_specs):
    """So nothing is ever weighed."""
    talk = make_talk(make_specs(text=UNLIMITED))
    talk.want(0.0)
    assert appraisal(talk).look_for_room(5.0, filmed(talk, 5, size=10**6), waiting=99)


@pytest.fixture
def rivals(make_specs):
    """Robots r1 and r2 have frames of 10 Hz, twice as much as the limit carries; r1 also has something small.

    Each has sent its last frame long ago, r2 before r1, and the next one of r2 is due at 10 s. Something else of r1 has
    just used 1 kB of the 2.45 kB to a window.
    """
    view = SharedView(CoreSettings("r1", "z-r1"), make_specs(window=0.25))
    view.add_peer(-90.0, "r2", "z-r2")
    view.subscribers.set_own(("robot/**",))
    for robot, key, size, sent in (("r1", CAMERA, SIZE, 9.0), ("r1", SMALL, 10, 9.9), ("r2", OTHERS, SIZE, 8.0)):
        stream = view.streams.touch(0.0, robot, key)
        stream.matching = True
        for count in range(100):
            stream.note_generated(count + 1, Generated(0.1 * count, size, 1.0))
        view.traffic.note_sent(stream, 1, Sent(sent, sent, size, 1.0))
    coordination = Coordination(0.0, view.settings, view)
    budget = Budget(view, coordination)
    limits = limits_of(view.specs, 0.02, 2)
    coordination.set_members(0.0, view.peers)
    coordination.set_limits(0.0, limits)
    budget.set_limits(limits)
    budget.use(9.95, (SIZE,))
    return Appraisal(view, budget, Disputes(view))


def test_how_a_sample_stands_follows_what_competes(rivals):
    """What takes next to nothing goes without a search, frames compete for the rest."""
    frames, small = (rivals.view.streams.known("r1", key) for key in (CAMERA, SMALL))
    assert rivals.weigh(10.0, small, waiting(SMALL, 10)) is Standing.UNDISPUTED
    assert rivals.weigh(10.0, frames, waiting()) is Standing.CONTESTED
    assert [rivals.all_go(key) for key in (CAMERA, SMALL, OTHERS)] == [False, True, False]


def test_a_stream_is_weighed_anew_when_far_more_is_known_of_it(rivals):
    """At its second, fourth and eighth sample, however lately that was done; later ones wait until it is time to."""
    key, weighed = "robot/r1c/camera", []
    new = rivals.view.streams.touch(10.0, "r1", key)
    new.matching = True
    for number in range(1, 20):
        now, before = 10.0 + 0.01 * number, rivals.disputes.weighed_at
        new.note_generated(number, Generated(now, 10, 1.0))
        rivals.weigh(now, new, waiting(key, 10))
        if rivals.disputes.weighed_at != before:
            weighed.append(number)
    assert weighed == [1, 2, 4, 8]


def test_a_copy_leaves_the_room_that_is_booked(rivals):
    """For what goes without a search: beside it there is less than the limit has."""
    free = rivals.budget.free(10.0)
    assert rivals.budget.lacking(10.0, tuple(free)) == ()
    assert rivals.weigh_copy(10.0, tuple(free)) == ("throughput",)
    assert rivals.weigh_copy(10.0, (free[0] - 30.0,)) == ()
    rivals.budget.use(10.0, tuple(free))
    assert rivals.lacking_beside_booked(10.0, (10.0,)) == ("throughput",)


def test_what_a_better_claim_may_just_have_had_sent_takes_the_room(rivals):
    """Until it is known what became of it; a little later it would have been heard of."""
    frames, size = rivals.view.streams.known("r1", CAMERA), rivals.budget.free(10.0)[0] - 0.5 * SIZE
    rivals.weigh(10.0, frames, waiting())
    lacking, until = rivals.lacking_beside_rivals(10.0, frames, (size,))
    assert lacking == ("throughput",)
    assert 10.0 < until < 10.1
    assert rivals.lacking_beside_rivals(10.0, frames, (0.1 * SIZE,))[0] == ()
    assert rivals.lacking_beside_rivals(10.05, frames, (size,))[0] == ()


def test_a_sample_larger_than_the_limit_gives_way_as_others_do(rivals):
    """Else all robots that have such sent at once, as each found the longer window empty: up to 3.8 limits in it."""
    frames, size = rivals.view.streams.known("r1", CAMERA), 1.2 * rivals.budget.limits[0].limit
    rivals.weigh(10.27, frames, waiting())
    rivals.budget.stretch.weigh(rivals.budget.limits, (0.0,), [((size,), (0.0,))])
    assert not rivals.budget.lacking(10.27, (size,))
    assert rivals.lacking_beside_rivals(10.27, frames, (size,))[0] == ("throughput",)


def test_nobody_is_waited_for_where_that_gains_nothing(rivals):
    """What no spec plans for has no claim, and who has gone sends nothing."""
    frames = rivals.view.streams.known("r1", CAMERA)
    rivals.weigh(10.0, frames, waiting())
    assert rivals.lacking_beside_rivals(10.0, None, (SIZE,)) == ((), math.inf)
    rivals.view.gone(1.0, "z-r2")
    assert rivals.lacking_beside_rivals(10.0, frames, (SIZE,)) == ((), math.inf)
