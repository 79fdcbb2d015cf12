"""What is booked as load, and what is left to contested messages; seen at a core that talks."""

import math
from dataclasses import replace

import pytest

from proxy.core.core import Core
from proxy.core.interface import events as ev
from proxy.core.interface.commands import Decide, Drop, Forward
from proxy.core.market.standing import Standing
from proxy.core.market.tuning import TUNING as MARKET
from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState, tag
from proxy.core.view.tuning import TUNING as VIEW
from proxy.recording.snapshots import restored, taken
from tests.proxy.core.talk import Talk, only
from tests.proxy.core.window.views import plan_of
from utility_specs import load_specs

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


def begun(path, *, allowance=0.0):
    """A robot with a camera of 10 Hz and odometry of 20 Hz whose samples somebody wants, known for 12 s."""
    path.write_text(SPEC)
    settings = CoreSettings("r1", "z-r1", coordination="announce", allowance=allowance)
    talk = Talk(Core(settings, load_specs(path), -10.0))
    talk.want(-10.0, keys=("robot/**",))
    run(talk, -9.99, 2.0)
    return talk


@pytest.fixture(scope="module")
def known(tmp_path_factory):
    """Such a robot, in a team that may tell nothing."""
    return begun(tmp_path_factory.mktemp("known") / "spec.toml")


@pytest.fixture
def talk(known):
    """The same robot for each test, as it is when it begins."""
    talk = Talk(restored(taken(known.core, 0, 2.0), known.core.view.specs))
    talk.samples = known.samples
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
    return talk.core.gate.appraisal.disputes


def test_small_samples_go_without_a_search_and_are_no_part_of_any(talk):
    """The tree holds frames alone."""
    problems = [decide.problem for decide in only(run(talk, 2.0, 4.0), Decide)]
    assert problems
    assert all({m.use[0] for m in p.messages} <= {0.0, FRAME} for p in problems)


def test_what_is_larger_than_our_part_is_no_part_of_plans(talk):
    """It waits for a turn, and what is smaller does not wait with it."""
    run(talk, 2.0, 4.0)
    (limit,) = talk.core.budget.usable(4.0)
    for part, waits in ((limit, False), (replace(limit, limit=0.9 * FRAME), True)):
        disputes(talk).advance(4.0, (part,), alone=True, turns=True)
        assert (("r1", "robot/r1/camera") in disputes(talk).settled) is waits


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
    odometry, camera = (talk.core.view.streams.known("r1", f"robot/r1/{key}") for key in ("odometry", "camera"))
    assert odometry.forwarded == odometry.generated == 400
    assert 52 <= camera.forwarded <= 2 * 20 / 0.5
    assert talk.core.counts.conserved


def test_a_first_alarm_goes_at_once(talk):
    """Nobody knows yet how often they come; they earn so much that it does not matter."""
    run(talk, 2.0, 3.0)
    alarm, said = talk.publish(3.0, "robot/r1/alarm", size=76)
    assert Forward(alarm) in only(said)


def test_an_alarm_of_a_stream_that_is_new_is_not_lost_beside_what_is_booked(talk):
    """It need not wait until all streams are weighed anew, and takes of what is left to small samples."""
    run(talk, 2.0, 3.0)
    talk.core.budget.use(3.0, (talk.core.budget.free(3.0)[0] - 400.0,))
    first, said = talk.publish(3.0, "robot/r2/alarm", size=76)
    second, more = talk.publish(3.0001, "robot/r3/alarm", size=76)
    assert [Forward(first), Forward(second)] == only([*said, *more])


@pytest.mark.parametrize(("late", "counts"), [(0.0, False), (0.002, False), (0.03, True)])
def test_what_is_booked_does_not_count_once_more_as_it_left_a_little_late(talk, late, counts):
    """Else plans have less room than there is, and who shares a limit with robots that send poses uses less of it."""
    run(talk, 2.0, 4.0)
    sends = talk.core.budget.own.since(3.5)
    small = [send for send in sends if send[1] == (116.0,)]
    assert len(small) > 5
    left = disputes(talk).unbooked(3.95, [(t + late, use) for t, use in sends], own=True)
    assert any(use == (116.0,) for _, use in left) is counts
    assert disputes(talk).unbooked(3.95, small, own=False) == tuple(small), "others' are not what is booked for us"


def test_where_many_speak_what_left_late_counts_once_more(talk):
    """They need the margin: each sends as the same window opens."""
    run(talk, 2.0, 4.0)
    for number in range(2, 4 + MARKET.few_others):
        talk.tell(ev.PeerAppeared(4.0, f"r{number}", f"z-r{number}"))
        talk.tell(ev.StateHeard(4.0, State(f"r{number}", f"z-r{number}", "enforce", "", (), (), number=1)))
    small = [send for send in talk.core.budget.own.since(3.5) if send[1] == (116.0,)]
    assert not disputes(talk).unbooked(3.95, small, own=True)
    late = tuple((t + 0.002, use) for t, use in small)
    assert disputes(talk).unbooked(3.95, late, own=True) == late


def test_an_alarm_waits_for_room_for_as_long_as_it_is_worth_half_of_what_it_was(talk):
    """Where others sent too much at once a sample of which each counts is not dropped; odometry gives way to newer."""
    run(talk, 2.0, 3.0)
    for k in range(4):
        talk.core.budget.use(3.0 + 0.3 * k, (LIMIT,))
    alarm, said = talk.publish(3.0, "robot/r1/alarm", size=76)
    odometry, more = talk.publish(3.0, "robot/r1/odometry", size=116)
    assert [Drop(odometry, "dropped:constraint")] == only([*said, *more])
    later = [command for k in range(30) for command in talk.tell(ev.TimePassed(3.05 + 0.05 * k))]
    assert only(later) == [Forward(alarm)]


def test_who_was_met_lately_is_taken_to_send_as_many_small_samples_as_we_do(talk):
    """Until its state tells; who says little is believed after a while."""
    run(talk, 2.0, 4.0)
    before, _ = disputes(talk).left(4.0)
    talk.tell(ev.PeerAppeared(4.0, "r2", "z-r2"))
    talk.tell(ev.StateHeard(4.0, State("r2", "z-r2", "enforce", "", (), (), number=1)))
    run(talk, 4.05, 6.0)
    after, _ = disputes(talk).left(6.0)
    odometry = 10 * 116
    assert before[0] - after[0] == pytest.approx(odometry, rel=0.2)
    run(talk, 6.0, 4.5 + VIEW.newcomer_time)
    assert disputes(talk).left(4.5 + VIEW.newcomer_time)[0] == pytest.approx(before, rel=0.01)


def test_prices_of_ours_count_what_robots_that_were_met_lately_are_taken_to_send(talk):
    """Small samples have no price alone; sixty robots that send as many fill the limit. Others do not bid as we do."""
    run(talk, 2.0, 4.0, camera=False)
    before = disputes(talk).last_prices(4.0, talk.core.budget.usable(4.0))
    for name in (f"r{k}" for k in range(2, 62)):
        talk.tell(ev.PeerAppeared(4.0, name, f"z-{name}"))
        streams = (StreamState(1, "robot/r2/odometry", "odometry", 0.1, size=116),) if name == "r2" else ()
        talk.tell(ev.StateHeard(4.0, State(name, f"z-{name}", "enforce", "", streams, (), number=1)))
    for number in range(1, 11):
        news = (StreamDigest(1, number, number, 4.0 + 0.1 * number, 4.0 + 0.1 * number, 116, 1.0),)
        digest = Digest("r2", tag("z-r2"), 4.0 + 0.1 * number, number, 116 * number, news, state=1)
        talk.tell(ev.DigestHeard(4.0 + 0.1 * number, digest, 40))
        run(talk, 4.0 + 0.1 * number, 4.1 + 0.1 * number, camera=False)
    streams, weighed = talk.core.view.streams, disputes(talk).weighed
    ours, others = (weighed(streams.known(robot, f"robot/{robot}/odometry")) for robot in ("r1", "r2"))
    assert before == (0.0,)
    assert disputes(talk).last_prices(5.0, talk.core.budget.usable(5.0)) > (0.0,)
    assert ours.cost > others.cost == 0.0


@pytest.mark.parametrize(("partial", "until"), [(False, 6.0), (True, 4.6)])
def test_what_others_do_not_tell_of_goes_on_as_it_did(talk, partial, until):
    """They tell of few streams at a time. Where its robot tells of all that is news it is silent until then."""
    talk.tell(ev.PeerAppeared(4.0, "r2", "z-r2"))
    streams = tuple(StreamState(k, f"robot/r2/{key}", key, 0.0) for k, key in ((1, "odometry"), (2, "alarm")))
    talk.tell(ev.StateHeard(4.0, State("r2", "z-r2", "enforce", "", streams, ("robot/**",), number=1)))
    told = [(1, 4.0 + 0.1 * number, number) for number in range(1, 7)]
    for stream, at, number in (*told, (2, 6.0, 7)):
        news = (StreamDigest(stream, number, number, at, at, 76, 1.0),)
        digest = Digest("r2", tag("z-r2"), at, number, number, news, state=1, partial=partial)
        talk.tell(ev.DigestHeard(at, digest, 40))
    known, streams = talk.core.view.staleness.known_until, talk.core.view.streams
    assert known(9.0, streams.known("r2", "robot/r2/odometry")) == pytest.approx(until)
    assert known(9.0, streams.known("r1", "robot/r1/odometry")) == 9.0


@pytest.mark.parametrize(("count", "presumed"), [(2, 10 * 116), (9, 0)])
def test_of_whom_news_are_late_before_its_rate_is_known_is_taken_to_send_as_we_do(talk, count, presumed):
    """Where robots may tell each other little; of a stream of which enough is known its own rate counts."""
    run(talk, 2.0, 4.0)
    before, _ = disputes(talk).left(4.0)
    talk.tell(ev.PeerAppeared(4.0, "r2", "z-r2"))
    told = StreamState(1, "robot/r2/odometry", "odometry", 0.0, size=1)
    talk.tell(ev.StateHeard(4.0, State("r2", "z-r2", "enforce", "", (told,), (), number=1)))
    for number in range(count):
        at = 4.01 + 0.1 * number
        news = (StreamDigest(1, number + 1, number + 1, at, at, 1, 1.0),)
        talk.tell(ev.DigestHeard(at, Digest("r2", tag("z-r2"), at, number + 1, number + 1, news, state=1), 40))
    end = 4.5 + VIEW.newcomer_time
    run(talk, 5.0, end)
    after, _ = disputes(talk).left(end)
    assert before[0] - after[0] == pytest.approx(presumed, abs=300)


def booked(talk, now):
    """What is booked of the limit now [B]."""
    return talk.core.budget.limits[0].limit - disputes(talk).left(now)[0][0]


@pytest.mark.full
def test_who_says_in_time_that_nothing_is_new_is_not_taken_to_send_as_we_do(tmp_path):
    """Its only sample was an alarm: news of it are rare, but not late."""
    talk = begun(tmp_path / "spec.toml", allowance=0.05)
    talk.tell(ev.PeerAppeared(2.0, "r2", "z-r2"))
    told = StreamState(1, "robot/r2/alarm", "alarm", 0.0, size=76)
    talk.tell(ev.StateHeard(2.0, State("r2", "z-r2", "enforce", "", (told,), (), number=1)))
    at, sent = 2.0, 0
    while at < 6.0 + VIEW.newcomer_time:
        run(talk, at, at + 0.5)
        at += 0.5
        first = not sent and at > 2.0 + VIEW.newcomer_time
        news = (StreamDigest(1, 1, 1, at, at, 76, 1.0),) if first else ()
        sent += first
        digest = Digest("r2", tag("z-r2"), at, sent, 76 * sent, news, state=1)
        settle(talk, at, talk.tell(ev.DigestHeard(at, digest, 40)), send=True)
    assert ("r2", "robot/r2/alarm") in disputes(talk).settled
    assert booked(talk, at) < 1.5 * 10 * 116


def test_a_plain_node_is_not_taken_to_send_as_we_do(tmp_path):
    """It never says how often it does; an app that sent one sample is no robot."""
    talk = begun(tmp_path / "spec.toml", allowance=0.05)
    talk.tell(ev.SampleHeard(2.0, "robot/r9/alarm", 76, "z-app", None, None))
    run(talk, 2.0, 5.0)
    assert ("?z-app", "robot/r9/alarm") in disputes(talk).settled
    assert booked(talk, 5.0) < 1.5 * 10 * 116


@pytest.mark.parametrize(("messages", "presumed"), [(0, 0.0), (1, 10 * 116)])
def test_a_robot_that_only_listens_is_soon_believed(talk, messages, presumed):
    """An operator: after a while its digests say that it has sent nothing."""
    run(talk, 2.0, 4.0)
    before, _ = disputes(talk).left(4.0)
    talk.tell(ev.PeerAppeared(4.0, "r2", "z-r2"))
    talk.tell(ev.StateHeard(4.0, State("r2", "z-r2", "enforce", "", (), (), number=1)))
    run(talk, 4.05, 6.5)
    digest = Digest("r2", tag("z-r2"), 6.5, messages, 100 * messages, state=1)
    settle(talk, 6.5, talk.tell(ev.DigestHeard(6.5, digest, 40)), send=True)
    run(talk, 6.5, 7.5)
    after, _ = disputes(talk).left(7.5)
    assert before[0] - after[0] == pytest.approx(presumed, abs=300)


@pytest.mark.parametrize("wanted", [True, False])
def test_a_robot_that_finds_no_room_does_not_only_listen(talk, wanted):
    """It has sent nothing, but would; of samples that nobody wants nothing is to come."""
    run(talk, 2.0, 4.0)
    talk.tell(ev.PeerAppeared(4.0, "r2", "z-r2"))
    camera = StreamState(1, "robot/r2/camera", "camera", 0.1, size=FRAME)
    talk.tell(ev.StateHeard(4.0, State("r2", "z-r2", "enforce", "", (camera,), ("robot/**",), number=1)))
    if not wanted:
        talk.want(4.0, keys=("robot/r2/odometry",))
    news = (StreamDigest(1, 25, 0, 6.4, 0.0, FRAME, 1.0),)
    run(talk, 4.05, 6.5)
    talk.tell(ev.DigestHeard(6.5, Digest("r2", tag("z-r2"), 6.5, 0, 0, news, state=1), 40))
    view = talk.core.view
    assert view.newcomers.only_listens(view.peers[tag("z-r2")]) is not wanted


def test_room_is_kept_for_small_samples_beside_frames_that_nearly_fill_the_limit(make_talk, make_specs):
    """Of such frames those go that are smaller than usual."""
    talk = make_talk(make_specs(text=SPEC))
    talk.want(-10.0, keys=("robot/**",))
    sizes, sent = (55_000, 58_500, 62_000, 56_000, 61_000, 60_000, 58_500), []
    for step in range(400):
        now = 0.05 * step
        for key, size in (("odometry", 400), *[("camera", sizes[step // 2 % 7])] * (step % 2 == 0)):
            _, said = talk.publish(now, f"robot/r1/{key}", size=size)
            if any(isinstance(each, Forward) for each in settle(talk, now, said, send=True)) and key == "camera":
                sent.append(size)
    assert len(sent) > 10
    assert set(sent[5:]) <= {55_000, 56_000}
    odometry = talk.core.view.streams.known("r1", "robot/r1/odometry")
    assert odometry.forwarded == odometry.generated


def test_room_that_is_kept_for_frames_is_not_what_others_use_of_it_untold(make_talk, make_specs):
    """Eight robots that may tell little sent small samples all the same: each frame went over the limit, by 1.3."""
    talk = make_talk(make_specs(text=SPEC))
    talk.want(-10.0, keys=("robot/**",))
    talk.tell(ev.PeerAppeared(-9.0, "r2", "z-r2"))
    streams = (StreamState(1, "robot/r2/odometry", "odometry", 0.05, size=1_000),)
    talk.tell(ev.StateHeard(-9.0, State("r2", "z-r2", "enforce", "", streams, (), number=1)))
    booked = []
    for step in range(1, 101):
        now = 0.05 * step
        if step <= 60:
            news = (StreamDigest(1, step, step, now, now, 1_000, 15.0),)
            talk.tell(ev.DigestHeard(now, Digest("r2", tag("z-r2"), now, step, 1_000 * step, news, state=1), 40))
        if step % 2 == 0:
            settle(talk, now, talk.publish(now, "robot/r1/camera", size=56_000, red=1.0)[1], send=step <= 60)
        if step in (60, 100):
            booked += disputes(talk).booked
    assert booked == [pytest.approx(talk.core.budget.limits[0].limit - 56_000), pytest.approx(10 * 1_000)]


def test_a_sample_that_is_worth_more_than_others_of_its_stream_is_decided(talk):
    """Its stream was weighed by what its last sample was worth."""
    stream = talk.core.view.streams.known("r1", "robot/r1/camera")
    run(talk, 2.0, 2.5)
    assert disputes(talk).weighed(stream).scale == 1.0
    talk.publish(4.0, "robot/r1/camera", size=FRAME, red=1.0)
    assert talk.core.gate.search.pending.sample.scale == 11.0


def test_streams_of_which_nothing_pays_are_dropped_without_a_search(make_talk, make_specs):
    """Beside frames that are worth ten thousand times as much."""
    spec = SPEC.replace('keys = ["robot/*/odometry"]', 'keys = ["robot/*/odometry"]\nweight = 1e-5')
    talk = make_talk(make_specs(text=spec))
    talk.want(-10.0, keys=("robot/**",))
    talk.tell(ev.TimePassed(-8.0))
    for step in range(80):
        now = 0.01 + 0.05 * step
        settle(talk, now, talk.publish(now, "robot/r1/odometry", size=6_000)[1], send=True)
        settle(talk, now, talk.publish(now, "robot/r1/camera", size=FRAME)[1], send=True)
    stream = talk.core.view.streams.known("r1", "robot/r1/odometry")
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


@pytest.mark.parametrize("worth", [0.1, 10.0])
def test_only_who_has_the_best_claim_waits_for_room_that_others_leave(talk, worth):
    """If all did several would send at once when it opens."""
    run(talk, 2.0, 3.0, send=False)
    told = (StreamState(1, "robot/r2/camera", "camera", 0.1, size=FRAME),)
    talk.tell(ev.PeerAppeared(3.0, "r2", "z-r2"))
    talk.tell(ev.StateHeard(3.0, State("r2", "z-r2", "enforce", "", told, (), number=1)))
    for k in range(10):
        news = StreamDigest(1, k + 2, 1, 3.0 + 0.1 * k, 1.95, FRAME, worth)
        talk.tell(ev.DigestHeard(3.05 + 0.1 * k, Digest("r2", tag("z-r2"), 3.04 + 0.1 * k, streams=(news,), state=1)))
    talk.tell(ev.SampleHeard(4.0, "robot/r3/camera", 60_000, "zz-unknown", None, {"red": 0.0}))
    run(talk, 3.5, 4.4, send=False)
    sample, said = talk.publish(4.45, "robot/r1/camera", size=FRAME)
    if worth > 1.0:
        assert Drop(sample, "dropped:constraint") in only(said)
    else:
        assert not only(said)
        assert only(talk.tell(ev.TimePassed(4.52)), Decide)


def test_what_is_larger_than_our_part_sets_no_price_for_what_is_not(talk):
    """A frame waits for its turn; meanwhile every small sample goes that fits in our part."""
    view, (limit,) = talk.core.view, talk.core.budget.limits
    odometry = view.streams.known("r1", "robot/r1/odometry")
    part = (replace(limit, limit=3_000.0),)
    for alone in (False, True):
        disputes(talk).advance(2.05, part, alone=alone, turns=alone)
        standing = disputes(talk).weighed(odometry).standing
        assert (standing is Standing.UNDISPUTED) == alone


def test_a_late_decision_leaves_small_samples_their_room(talk):
    """A frame that fits beside what was sent, but not beside what is booked, does not go without a search either."""
    run(talk, 2.0, 3.0, send=False)
    free = talk.core.budget.free(3.0)[0]
    talk.core.budget.use(3.0, (free - FRAME - 2_000.0,))
    _, said = talk.publish(3.0, "robot/r1/camera", size=FRAME)
    (decide,) = only(said, Decide)
    talk.core.budget.use(3.001, (1_950.0,))
    (late,) = only(talk.tell(ev.DecisionLate(3.02, decide.ticket)))
    assert late.reason == "dropped:fallback"
    assert talk.core.budget.free(3.02)[0] > FRAME


ENDING = """
[[constraint]]
kind = "throughput"
limit = "16 kbit/s"
window = 0.5
[[information_type]]
name = "finding"
keys = ["robot/*/finding/*"]
aggregation = "{aggregation}"
utility = {{ kind = "linear", slope = 1.0 }}
scale = "red"
features.red = {{ kind = "color_fraction", color = "red" }}
"""


@pytest.mark.full
@pytest.mark.parametrize(("aggregation", "at_once"), [("most_recent", False), ("current", True)])
def test_that_something_is_gone_is_sent_at_once(make_talk, make_specs, aggregation, at_once):
    """Twenty small streams of 10 Hz of which the limit carries some; what one of them found is gone at 6 s."""
    talk = make_talk(make_specs(text=ENDING.format(aggregation=aggregation)))
    talk.want(-0.5, keys=("robot/**",))
    told = []
    for step in range(100):
        for number in range(20):
            now = 0.01 + 0.1 * step + 0.004 * number
            red = 1.0 if number == 0 and step < 60 else 0.05
            searched(talk, now, talk.publish(now, f"robot/r1/finding/{number}", size=40, red=red)[1])
            stream = talk.core.view.streams.known("r1", "robot/r1/finding/0")
            if step >= 60 and stream.sent.t_gen > 6.0:
                told.append(now)
    assert (bool(told) and told[0] < 6.3) is at_once
    assert stream.forwarded < stream.generated


def searched(talk, now, said):
    """Let the planner answer what is to be decided; return what was commanded."""
    found = list(said)
    for decide in only(said, Decide):
        found += searched(talk, now, talk.tell(ev.DecisionReady(now, decide.ticket, plan_of(decide.problem))))
    return found


def search_begun(talk, now):
    """Publish frames from this time on until one is searched for; return when that is, its number and the search."""
    while True:
        now = round(now + 0.1, 6)
        frame, commands = talk.publish(now, size=FRAME, red=0.1)
        if decides := only(commands, Decide):
            return now, frame, decides[0]


def test_what_nothing_disputes_goes_beside_a_search(talk):
    """It waits for no answer, and the search goes on."""
    now, frame, decide = search_begun(talk, 2.0)
    for late in (0.001, 0.002):
        sample, commands = talk.publish(now + late, "robot/r1/odometry", size=300)
        assert only(commands) == [Forward(sample)]
    assert only(talk.answer(now + 0.003, decide, send=True)) == [Forward(frame)]


def test_a_sample_that_finds_no_room_beside_one_that_overtook_it_waits(talk):
    """It is not lost, nor is more sent than the limit allows."""
    now, frame, decide = search_begun(talk, 2.0)
    left = int(talk.core.budget.free(now)[0])
    sample, commands = talk.publish(now + 0.001, "robot/r1/odometry", size=left - FRAME // 2)
    assert only(commands) == [Forward(sample)]
    assert only(talk.answer(now + 0.002, decide, send=True)) == []
    assert [waiting.sample for waiting, _ in talk.core.gate.undecided_of("robot/r1/camera")] == [frame]
    assert talk.core.budget.free(now + 0.002)[0] >= 0.0


def test_streams_are_weighed_ahead_where_samples_come_often(talk):
    """Once it is time to, so that the next sample finds it done; not where none came since it was weighed last."""
    now, _, decide = search_begun(talk, 2.0)
    talk.answer(now, decide, send=True)
    disputes = talk.core.gate.appraisal.disputes
    before, due = disputes.weighed_at, disputes.weighed_at + MARKET.interval
    while now + 0.1 < due:
        now = round(now + 0.1, 6)
        searched(talk, now, talk.publish(now, size=FRAME, red=0.1)[1])
    assert (disputes.weighed_at, disputes.due_at) == (before, due)
    assert talk.core.wake_at(now) <= due
    talk.tell(ev.TimePassed(due))
    assert (disputes.weighed_at, disputes.due_at) == (due, math.inf)
    talk.tell(ev.TimePassed(due + MARKET.interval))
    assert disputes.weighed_at == due


def test_what_waits_is_not_looked_at_while_an_answer_is_awaited(talk):
    """It could not be taken up: the core was asked again and again for as long as the search took."""
    now, _, decide = search_begun(talk, 2.0)
    gate, due_at = talk.core.gate, talk.core.parts.due_at
    before, gate.wakes_at = due_at(now), now - 1.0
    assert due_at(now) == before > now
    talk.answer(now, decide, send=False)
    gate.wakes_at = now - 1.0
    assert due_at(now) == now
