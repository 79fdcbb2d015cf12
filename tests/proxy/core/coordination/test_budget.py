"""What may still be sent."""

import itertools
import math
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from planner.measures import Throughput
from proxy.core.coordination.budget import grew, in_turn, sustained
from proxy.core.coordination.tuning import TUNING
from proxy.core.interface import events as ev
from proxy.core.model.limits import Limit
from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState
from proxy.core.view.stream import Generated
from tests.proxy.core.coordination.conftest import BYTES, COUNT, ENERGY, heard


def test_what_was_sent_counts_for_a_window(make_budget):
    """Ours and what is known of others, in both ends of the window."""
    budget, view = make_budget()
    budget.use(1.0, (300.0,))
    heard(view, 1.5, 400)
    assert budget.used(1.5, 0) == 300.0
    assert budget.free(1.5) == [300.0]
    assert not budget.lacking(1.6, (300.0,))
    assert budget.lacking(1.6, (301.0,)) == ("bytes",)
    assert budget.free(2.0) == [300.0]
    assert budget.free(2.0 + TUNING.least_limit) == [600.0]
    assert budget.free(2.6) == [1000.0]


def test_when_room_opens_that_our_own_sends_leave_is_known(make_budget):
    """Then the sample does fit. What another robot leaves is not ours to wait for."""
    budget, view = make_budget()
    budget.use(1.0, (300.0,))
    budget.use(1.2, (300.0,))
    heard(view, 1.4, 300)
    opens = [budget.opens(1.5, (size,)) for size in (100.0, 300.0, 700.0, 800.0, 1001.0)]
    assert opens == pytest.approx([-math.inf, 2.0, 2.2, math.inf, math.inf], abs=1e-5)
    assert not budget.lacking(opens[2], (700.0,))


def test_room_opens_later_when_more_was_sent_meanwhile(make_budget):
    """By us or by others; what was known of a moment ago holds no longer."""
    budget, view = make_budget()
    budget.use(1.0, (300.0,))
    budget.use(1.2, (500.0,))
    assert budget.opens(1.3, (300.0,)) == pytest.approx(2.0, abs=1e-5)
    budget.use(1.3, (200.0,))
    assert budget.opens(1.3, (400.0,)) == pytest.approx(2.2, abs=1e-5)
    heard(view, 1.4, 900)
    assert budget.opens(1.4, (400.0,)) == math.inf
    assert budget.opens(1.4, (400.0,), anybodys=True) == pytest.approx(2.4, abs=1e-5)


def test_a_sample_that_cannot_be_announced_yet_waits_until_it_can(make_budget):
    """Though there is room for it: an alarm was dropped at once else. A small one goes, as nobody has to hear of it."""
    budget, _ = make_budget()
    budget.mute(1.8)
    assert budget.lacking(1.3, (300.0,)) == ("bytes",)
    assert budget.opens(1.3, (300.0,)) == 1.8
    assert budget.opens(1.3, (1.0,)) == budget.opens(1.8, (300.0,)) == -math.inf


def test_in_a_long_window_no_more_may_be_used_than_leaves_room_on_the_way(make_budget):
    """Who sent much at first has less for a while, and all of it when that leaves; in a short one it counts no less."""
    long = Limit("bytes", 20.0, 20_000.0, Throughput(20_000.0, 20.0))
    budget, view = make_budget(long)
    assert sustained(budget, 0.0) == (1000.0,)
    budget.use(1.0, (7_000.0,))
    heard(view, 1.5, 8_000)
    assert sustained(budget, 2.0) == (1000.0,)
    heard(view, 4.0, 3_000)
    assert sustained(budget, 5.0) == (pytest.approx(400.0),), "2,000 B are left for the next 5 s"
    assert sustained(budget, 20.5) == (1000.0,), "all but 3,000 B leave soon"
    short, view = make_budget()
    heard(view, 1.0, 900)
    assert sustained(short, 1.5) == (1000.0,)


def test_a_sample_waits_for_a_part_that_grows(make_budget):
    """As what others sent in a slot of ours leaves the window; for more than that nothing waits."""
    budget, _ = make_budget(kind="split", peers=0)
    coordination = budget.coordination
    coordination.advance(0.5, (BYTES,), 0.0, lambda _: 0.0, lambda _: 0.0, passes_at=lambda now: now)
    grows = coordination.grows_at(0.6)
    assert 0.6 < grows < math.inf
    assert budget.lacking(0.6, (900.0,))
    assert budget.opens(0.6, (900.0,)) == grows
    assert not budget.lacking(grows, (900.0,))
    assert budget.opens(0.6, (1001.0,)) == math.inf
    assert budget.opens(grows, (1001.0,)) == math.inf


def test_what_others_send_uses_none_of_our_energy(make_budget):
    """Each robot has its own, whole, in either coordination."""
    for coordination in ("announce", "split"):
        budget, view = make_budget(BYTES, COUNT, ENERGY, kind=coordination, peers=3)
        heard(view, 1.0, 900)
        assert budget.whole(1.0, 2) == 3.0
        assert budget.free(1.1)[2] == 3.0


def test_in_split_each_robot_has_its_part_and_others_sends_are_their_own(make_budget):
    """A newcomer has little until it is given more."""
    budget, view = make_budget(BYTES, kind="split", peers=3)
    assert budget.alone
    assert budget.whole(0.0, 0) * 4 <= 1000.0
    heard(view, 1.0, 900)
    assert budget.others(1.1) == ()
    assert budget.free(1.1) == [budget.whole(1.1, 0)]
    limits = budget.problem_limits(1.1)
    assert limits.alone
    assert limits.others == ()
    assert limits.union == (replace(BYTES, limit=budget.whole(1.1, 0)),)


def test_a_problem_has_what_still_counts(make_budget):
    """Our sends and the others', of the longest window."""
    budget, view = make_budget(BYTES, COUNT)
    for now in (0.2, 1.0, 1.2):
        budget.use(now, (100.0, 1.0))
    heard(view, 0.1, 50)
    heard(view, 1.1, 60)
    limits = budget.problem_limits(1.3)
    assert not limits.alone
    assert limits.union == (BYTES, COUNT)
    assert limits.sent == ((1.0, (100.0, 1.0)), (1.2, (100.0, 1.0)))
    assert limits.others == ((1.1, (60.0, 1.0)),)


def large_team(make_budget, robots, size):
    """Return what one of so many robots may send, each of which has a camera with samples of a size, and its view."""
    budget, view = make_budget(peers=robots - 1)
    for number, robot in enumerate(("r1", *view.peers)):
        stream = view.streams.touch(0.0, robot, f"robot/{robot}/camera")
        stream.matching = True
        for count in range(9):
            stream.note_generated(count + 1, Generated(count - 9.0 + number / robots, size, 1.0))
    return budget, view


def test_in_a_large_team_a_message_larger_than_a_part_goes_once_in_a_turn(make_budget):
    """Another one may go in the next turn, and is told when that begins."""
    robots = TUNING.large_team + 1
    large = (3.0 * BYTES.limit / robots,)
    budget, _ = large_team(make_budget, robots, round(large[0]))
    budget.coordination.advance(0.1, budget.limits, 99.0, lambda _: 0.0, lambda _: 1.0, passes_at=lambda now: now)
    sent, opens = list[float](), -math.inf
    for number in range(3000):
        now = 0.1 + 0.01 * number
        if budget.lacking(now, large):
            opens = budget.opens(now, large)
            assert opens > now
        else:
            assert now >= opens
            assert budget.opens(now, large) == -math.inf
            budget.use(now, large)
            sent.append(now)
    apart = [later - earlier for earlier, later in itertools.pairwise(sent[1:])]
    assert len(apart) > 3
    assert min(apart) > 3.0 * BYTES.window
    assert max(apart) == pytest.approx(min(apart), abs=0.02)


def test_only_what_is_much_larger_than_an_equal_part_goes_by_turn(make_budget):
    """Once the team is known to be large; where others use little no search is needed."""
    robots = TUNING.large_team + 1
    large, small = (1.6 * BYTES.limit / robots,), (1.4 * BYTES.limit / robots,)
    budget, view = large_team(make_budget, robots, round(large[0]))
    assert not budget.by_turn(0.1, large)
    budget.coordination.advance(0.1, budget.limits, 99.0, lambda _: 0.0, lambda _: 0.1, passes_at=lambda at: at)
    assert budget.by_turn(0.1, large)
    assert not budget.by_turn(0.1, small)
    assert not in_turn(budget, 0.1, large), "it is more than our part, so a search decides"
    for step in range(1, 2000):
        now = 0.1 + 0.01 * step
        for stream in view.streams if step % 100 == 0 else ():
            stream.note_generated(stream.generated + 1, Generated(now, round(large[0]), 1.0))
        budget.coordination.advance(now, budget.limits, 99.0, lambda _: 0.0, lambda _: 0.1, passes_at=lambda at: at)
    assert in_turn(budget, now, large), "where others use little our part is larger"
    assert not in_turn(budget, now, small)


def test_traffic_that_nobody_decided_on_leaves_a_part(make_budget):
    """However much it is, it counts up to that part of what is ours."""
    budget, _ = make_budget()
    budget.use_at_most(1.0, (5000.0,), 0.9)
    assert budget.used(1.0, 0) == 900.0
    budget.use_at_most(1.1, (5000.0,), 0.9)
    assert budget.used(1.1, 0) == 900.0
    assert not budget.lacking(1.2, (100.0,))


def test_without_limits_everything_fits(make_budget):
    """Nothing lacks, and nothing has to be waited for."""
    budget, _ = make_budget()
    budget.use(0.5, (1000.0,))
    budget.set_limits(())
    assert not budget.lacking(1.0, ())
    assert budget.free(1.0) == []
    assert budget.opens(1.0, ()) == -math.inf


def test_what_others_are_heard_or_told_to_send_counts_once(make_talk):
    """A sample that came, and the announcement of it."""
    talk = make_talk(transport="broadcast x", allowance=0.02)
    camera = (StreamState(1, "robot/op/camera", "camera", 0.5, size=900),)
    talk.tell(ev.PeerAppeared(0.0, "op", "zz-op"))
    state = State("op", "zz-op", "enforce", "", camera, ("**",), transport="broadcast x", number=1)
    talk.tell(ev.StateHeard(0.0, state))
    for count, now in enumerate((0.2, 0.7), start=1):
        news = StreamDigest(1, count, 0, now, 0.0, 900, 1.0)
        talk.tell(ev.DigestHeard(now, Digest("op", "zz-op", now, streams=(news,), state=1)))
    talk.tell(ev.SampleHeard(1.0, "robot/op/camera", 900, "zz-op", None, None))
    news = StreamDigest(1, 3, 1, 1.0, 1.0, 900, 1.0)
    talk.tell(ev.DigestHeard(1.01, Digest("op", "zz-op", 1.01, streams=(news,), state=1, brief=True)))
    assert [use for _, use in talk.core.budget.others(1.1) if use[0] > 100.0] == [(900.0,)]  # the rest are digests


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.sampled_from(("announce", "split")),
    st.lists(st.tuples(st.floats(0.01, 0.6), st.integers(1, 1200), st.booleans()), min_size=5, max_size=60),
)
def test_whoever_sends_what_fits_keeps_every_limit(make_budget, coordination, steps):
    """Whatever others are heard to send meanwhile, no send of ours ends a window that holds more than we may use."""
    budget, view = make_budget(BYTES, COUNT, kind=coordination, peers=2)
    now, sent = 0.0, []
    for pause, size, ours in steps:
        now += pause
        use = (float(size), 1.0)
        if not ours:
            heard(view, now, size)
            sent += [(now, use, False)] * (coordination == "announce")
        elif size <= budget.whole(now, 0) and not budget.lacking(now, use):
            budget.use(now, use)
            sent.append((now, use, True))
    for end, _, ours in sent:
        for k, limit in enumerate((BYTES, COUNT) if ours else ()):
            window = sum(use[k] for t, use, _ in sent if end - limit.window <= t <= end and (t < end or _))
            assert window <= budget.whole(end, k) + 1e-6


def test_room_grew_last_when_a_large_send_left_the_window(make_budget):
    """Ours or another robot's; what is small makes no room that anybody waits for."""
    budget, view = make_budget()
    budget.use(1.0, (300.0,))
    heard(view, 1.2, 300)
    budget.use(1.3, (5.0,))
    assert grew(budget, budget.limits, 1.9) == -math.inf
    assert grew(budget, budget.limits, 2.1) == pytest.approx(2.0)
    assert grew(budget, budget.limits, 2.5) == pytest.approx(2.2)
    assert grew(budget, budget.limits, 1.9, 0.1) == pytest.approx(2.0)


def test_a_little_is_ours_whatever_others_say(make_budget):
    """An eighth of an equal part, for messages of a quarter of it at most; nothing of what is not shared."""
    budget, view = make_budget(BYTES, ENERGY, peers=4)
    heard(view, 1.0, 1_000_000)
    for number in range(4):
        assert budget.lacking(1.1, (7.0, 0.1)) == ("bytes",)
        assert budget.certain_at(1.1, (7.0, 0.1)) > 1.1
        assert not budget.lacking(1.1, (6.0, 0.1)), number
        assert budget.certain_at(1.1, (6.0, 0.05)) <= 1.1
        assert budget.opens(1.1, (6.0, 0.1)) == -math.inf
        budget.use(1.1, (6.0, 0.6))
    assert budget.lacking(1.2, (6.0, 1.0)) == ("bytes", "energy")
    assert budget.certain_at(1.2, (6.0, 0.05)) > 1.2
    assert not budget.lacking(2.2, (6.0, 0.1))


def test_that_little_is_ours_from_the_first_word_of_another_robot_until_nothing_counts_of_it(make_budget):
    """Also once it has left: who came, claimed gigabytes and left had a tenth of all alarms dropped."""
    budget, view = make_budget()
    assert budget.certain_at(1.0, (6.0,)) == math.inf
    heard(view, 1.0, 1_000_000)
    assert not budget.lacking(1.0, (6.0,))
    view.gone(1.1, "p0")
    budget.coordination.set_members(1.1, ())
    assert not budget.lacking(1.2, (6.0,))
    view.sweep(60.0)
    assert budget.certain_at(60.0, (6.0,)) == math.inf


def test_when_that_little_has_room_is_known(make_budget):
    """As far as our own sends take it, and what is ours alone; never for what is not small."""
    budget, view = make_budget(BYTES, ENERGY, peers=4)
    heard(view, 1.0, 1)
    assert budget.certain_at(1.1, (6.0, 0.05)) < 1.1
    budget.use(1.1, (20.0, 0.1))
    assert budget.certain_at(1.2, (6.0, 0.05)) == pytest.approx(2.1)
    budget.use(1.2, (1.0, 2.87))
    assert budget.certain_at(1.3, (1.0, 0.05)) == pytest.approx(3.1)
    assert budget.certain_at(1.3, (7.0, 0.1)) == math.inf


def test_what_takes_much_of_what_is_ours_alone_is_not_small(make_budget):
    """Our own streams compete for that, so it is searched for, as by a robot that is alone."""
    budget, view = make_budget(ENERGY, peers=1)
    heard(view, 1.0, 1)
    assert budget.certain_at(1.1, (0.05,)) < 1.1
    assert budget.certain_at(1.1, (1.0,)) == math.inf
