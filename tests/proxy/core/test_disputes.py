"""What is booked as load, and what is left to contested messages; seen at a core that talks."""

from dataclasses import replace

import pytest

from proxy.core import events as ev
from proxy.core.commands import Decide, Drop, Forward
from proxy.core.prices import Standing
from tests.proxy.core.talk import only

SPEC = """
[[constraint]]
kind = "throughput"
limit = "1 Mbit/s"
window = 0.5
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
scale = "1 + 10 * red"
features.red = { kind = "color_fraction", color = "red" }
utility = { kind = "video" }
[[information_type]]
name = "odometry"
keys = ["robot/*/odometry"]
utility = { kind = "linear", slope = 1.0 }
[[information_type]]
name = "alarm"
keys = ["robot/*/alarm"]
aggregation = "sum"
weight = 20
utility = { kind = "step", lifetime = "10 s" }
"""
LIMIT, FRAME = 62_500, 26_000


@pytest.fixture
def talk(make_talk, make_specs):
    """A robot with a camera of 10 Hz and odometry of 20 Hz whose samples somebody wants, known for 2 s."""
    talk = make_talk(make_specs(text=SPEC))
    talk.want(0.0, keys=("robot/**",))
    run(talk, 0.01, 2.0)
    return talk


def run(talk, begin, end, *, send=True, camera=True):
    """Publish from `begin` to `end`, and answer what is to be decided; return what was commanded."""
    outcomes = []
    for step in range(round(begin / 0.05), round(end / 0.05)):
        now = 0.01 + 0.05 * step
        for key, size in (("odometry", 116), *[("camera", FRAME)] * (camera and step % 2 == 0)):
            _, said = talk.publish(now, f"robot/r1/{key}", size=size)
            outcomes += settle(talk, now, said, send=send)
    return outcomes


def settle(talk, now, said, *, send):
    found = list(said)
    for decide in only(said, Decide):
        found += settle(talk, now + 0.002, talk.answer(now + 0.002, decide, send=send), send=send)
    return only(found, Forward, Drop, Decide)


def disputes(talk):
    return talk.core.gate._windows.disputes


def test_small_samples_go_without_a_search_and_are_no_part_of_any(talk):
    """The tree holds frames alone."""
    problems = [decide.problem for decide in only(run(talk, 2.0, 4.0), Decide)]
    assert problems
    assert all({m.use[0] for m in p.messages} <= {0.0, FRAME} for p in problems)


def test_frames_compete_for_what_small_samples_leave(talk):
    """The limit of a problem is lower by the reserve, and what is booked is no traffic besides."""
    run(talk, 2.0, 4.0, send=False)
    run(talk, 4.0, 4.6, send=False, camera=False)
    _, said = talk.publish(4.6, "robot/r1/camera", size=FRAME)
    (decide,) = only(said, Decide)
    (limit,) = decide.problem.constraints
    assert LIMIT - 2_000 < limit.limit < LIMIT - 10 * 116
    assert sum(each.use[0] for each in decide.problem.traffic) == 0.0


def test_every_small_sample_finds_room_however_many_frames_go(talk):
    """All frames that fit are sent, and no odometry is dropped."""
    run(talk, 2.0, 10.0)
    odometry, camera = (talk.core.view.known("r1", f"robot/r1/{key}") for key in ("odometry", "camera"))
    assert odometry.forwarded == odometry.generated == 200
    assert 26 <= camera.forwarded <= 2 * 10 / 0.5
    assert talk.core.counts.conserved


def test_a_first_alarm_goes_at_once(talk):
    """Nobody knows yet how often they come; they earn so much that it does not matter."""
    run(talk, 2.0, 3.0)
    alarm, said = talk.publish(3.0, "robot/r1/alarm", size=76)
    assert Forward(alarm) in only(said)


def test_a_sample_that_is_worth_more_than_others_of_its_stream_is_decided(talk):
    """Its stream was weighed by what its last sample was worth."""
    stream = talk.core.view.known("r1", "robot/r1/camera")
    run(talk, 2.0, 2.5)
    assert disputes(talk).weighed(stream).scale == 1.0
    talk.publish(4.0, "robot/r1/camera", size=FRAME, red=1.0)
    assert talk.core.gate.pending.sample.scale == 11.0


def test_streams_of_which_nothing_pays_are_dropped_without_a_search(make_talk, make_specs):
    """Beside frames that are worth ten thousand times as much."""
    spec = SPEC.replace('keys = ["robot/*/odometry"]', 'keys = ["robot/*/odometry"]\nweight = 1e-5')
    talk = make_talk(make_specs(text=spec))
    talk.want(0.0, keys=("robot/**",))
    for step in range(80):
        now = 0.01 + 0.05 * step
        settle(talk, now, talk.publish(now, "robot/r1/odometry", size=6_000)[1], send=True)
        settle(talk, now, talk.publish(now, "robot/r1/camera", size=FRAME)[1], send=True)
    stream = talk.core.view.known("r1", "robot/r1/odometry")
    assert disputes(talk).weighed(stream).standing is Standing.HOPELESS
    sample, said = talk.publish(4.01, "robot/r1/odometry", size=6_000)
    assert Drop(sample, "dropped:planner") in only(said)
    assert talk.core.status(4.1)["decisions"]["hopeless"] > 0


def test_a_frame_waits_for_the_room_that_our_own_frames_leave(talk):
    """A little later than it was generated, and before the next one is."""
    run(talk, 2.0, 4.0, send=False)
    run(talk, 4.0, 4.6, send=False, camera=False)
    for now in (4.6, 4.7):
        sample, said = talk.publish(now, "robot/r1/camera", size=FRAME)
        assert Forward(sample) in settle(talk, now, said, send=True)
    _, said = talk.publish(5.05, "robot/r1/camera", size=FRAME)
    assert not only(said)
    assert 5.1 < talk.core.gate.wakes_at < 5.11
    assert only(talk.tell(ev.TimePassed(talk.core.gate.wakes_at)), Decide)


def test_a_sample_of_which_each_counts_waits_for_room(talk):
    """For a window at most: an alarm is never lost to what we sent ourselves."""
    talk.publish(2.1, "robot/r1/alarm", size=76)
    for number in range(40):
        talk.publish(2.2 + 0.0001 * number, f"robot/r1/{number}/alarm", size=LIMIT // 50)
    alarm, said = talk.publish(2.3, "robot/r1/alarm", size=LIMIT // 3)
    assert not only(said, Drop)
    for step in range(60):
        settle(talk, 2.3 + 0.02 * step, talk.tell(ev.TimePassed(2.3 + 0.02 * step)), send=True)
    assert Forward(alarm) in talk.all(Forward)


def test_nobody_waits_for_room_that_others_leave(talk):
    """Several would, and all send when it opens."""
    run(talk, 2.0, 3.0, send=False)
    talk.tell(ev.SampleHeard(4.0, "robot/r2/camera", 60_000, "zz-unknown", None, {"red": 0.0}))
    sample, said = talk.publish(4.45, "robot/r1/camera", size=FRAME)
    assert Drop(sample, "dropped:constraint") in only(said)


def test_what_is_larger_than_our_part_sets_no_price_for_what_is_not(talk):
    """A frame waits for its turn; meanwhile every small sample goes that fits in our part."""
    view, (limit,) = talk.core.view, talk.core.budget.limits
    odometry = view.known("r1", "robot/r1/odometry")
    part = (replace(limit, limit=3_000.0),)
    for alone in (False, True):
        disputes(talk).look(2.05, part, alone=alone)
        standing = disputes(talk).weighed(odometry).standing
        assert standing is (Standing.UNDISPUTED if alone else Standing.PRICED)
