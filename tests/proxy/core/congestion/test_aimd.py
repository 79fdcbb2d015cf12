"""Estimates grow by addition, decrease by multiplication, stay between floor and ceiling; whose report counts."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import Throughput
from proxy.core.congestion.aimd import AdaptiveLimit, Aimd, CapacityReports
from proxy.core.congestion.tuning import TUNING
from proxy.core.model.limits import Limit
from proxy.core.protocol.messages import Digest

AIR = Limit("air", 0.5, 5e4, Throughput(1e5), 0.05)
DEEDS = st.lists(
    st.one_of(
        st.tuples(st.just("increase"), st.floats(0.0, 5.0), st.floats(0.0, 2.0), st.floats(0.0, 1.0)),
        st.tuples(st.just("decrease"), st.floats(0.0, 1.0), st.floats(0.0, 1.0), st.floats(0.0, 10.0)),
        st.tuples(st.just("decay")),
        st.tuples(st.just("await_others")),
        st.tuples(st.just("decrease_to"), st.floats(0.0, 2.0), st.floats(0.0, 10.0)),
        st.tuples(st.just("hold_back")),
        st.tuples(st.just("extend_drain"), st.floats(0.0, 5.0)),
        st.tuples(st.just("restore"), st.floats(0.0, 2.0)),
    ),
    max_size=50,
)


@given(st.floats(0.001, 0.99), DEEDS)
def test_it_stays_between_floor_and_ceiling(floor, deeds):
    """Whatever happens; growth never lowers it, and nothing else but the end of a trial raises it."""
    aimd, now = Aimd(0.0, floor), 0.0
    for name, *words in deeds:
        now += 0.3
        before = aimd.estimate
        getattr(aimd, name)(
            *(
                [now, *words]
                if name in ("increase", "decrease", "extend_drain", "await_others", "decrease_to", "hold_back")
                else words
            )
        )
        assert floor <= aimd.allowed(now) <= aimd.estimate <= 1.0
        assert (aimd.estimate >= before) if name in ("increase", "restore") else (aimd.estimate <= before)
        assert name not in ("decrease", "decrease_to") or aimd.settled_at >= aimd.drained_at


@given(st.floats(0.001, 0.99), st.floats(0.0, 1.0), st.booleans())
def test_a_follower_takes_over_what_it_agrees_with_and_what_is_less(floor, word, agrees):
    """Never less than the floor."""
    aimd = Aimd(0.0, floor)
    before = aimd.estimate
    aimd.follow(word, agrees=agrees)
    assert aimd.estimate == max(floor, word if agrees else min(before, word))


def settled(part=0.5):
    """An estimate of so much that was cut once, long ago."""
    aimd = Aimd(0.0, 0.05)
    aimd.restore(part / 0.9)
    aimd.decrease(1.0, 1.0, 1.0, 0.1)
    assert aimd.estimate == pytest.approx(part)
    return aimd


def test_it_grows_by_addition_once_it_was_cut():
    """By as much each second, more the longer nothing stands in its way; before, and up to what others know, fast."""
    aimd = settled()
    aimd.increase(2.0, 1.0, 1.0, 0.1)
    assert aimd.estimate == pytest.approx(0.5 + TUNING.increase)
    aimd.increase(1.0 + TUNING.calm_after + 2.0, 1.0, 1.0, 0.1)
    assert aimd.estimate == pytest.approx(0.5 + 4 * TUNING.increase)
    aimd.increase(9.0, 0.1, 1.0, 0.0)
    assert aimd.estimate == pytest.approx(0.5 + 4.1 * TUNING.increase)
    aimd.increase(10.0, 1.0, 1.0, 0.8)
    assert aimd.estimate == pytest.approx(1.5 * (0.5 + 4.1 * TUNING.increase))
    first = Aimd(0.0, 0.05)
    first.increase(1.0, 1.0, 1.0, 0.0)
    assert first.estimate == pytest.approx(1.5 * math.sqrt(0.05))


def test_it_does_not_grow_beyond_what_is_tested():
    """Nor shrinks to it."""
    aimd = settled()
    aimd.increase(2.0, 1.0, 0.51, 0.0)
    assert aimd.estimate == pytest.approx(0.51)
    aimd.increase(3.0, 1.0, 0.3, 0.0)
    assert aimd.estimate == pytest.approx(0.51)


def test_a_cut_goes_to_what_came_through_and_lower_until_the_queue_has_drained():
    """Half of 0.8 came through and 0.2 s wait: less for half a second, a little below half of it from then on."""
    aimd = settled(0.9)
    aimd.decrease(10.0, 0.8, 0.5, 0.2)
    assert aimd.estimate == pytest.approx(0.4)
    assert aimd.allowed(10.1) == pytest.approx(0.6 * 0.4)
    assert aimd.allowed(aimd.drained_at) == pytest.approx(0.4)
    assert aimd.drained_at == pytest.approx(10.5)


def test_a_cut_that_did_not_help_is_followed_by_a_deeper_one():
    """A full queue does not grow: nothing tells how much comes through."""
    aimd = settled(0.9)
    aimd.decrease(10.0, 0.9, 1.0, 0.1)
    assert aimd.estimate == pytest.approx(0.9 * 0.9)
    aimd.decrease(aimd.settled_at + 0.1, 0.9, 1.0, 0.1)
    assert aimd.estimate == pytest.approx(0.9 * 0.9 * 0.7)


def test_after_silence_it_may_grow_fast():
    """Nothing is known of the channel then."""
    aimd = settled()
    aimd.decay()
    assert aimd.estimate == pytest.approx(0.35)
    aimd.increase(2.0, 1.0, 1.0, 0.0)
    assert aimd.estimate == pytest.approx(0.35 * 1.5)
    aimd.await_others(5.0)
    assert aimd.settled_at > 5.0


@pytest.mark.parametrize("floor", [0.0001, 0.05, 0.9])
def test_it_begins_between_floor_and_ceiling(floor):
    """As many times above the one as below the other."""
    begin = Aimd(0.0, floor).estimate
    assert begin / floor == pytest.approx(1.0 / begin)


def test_a_long_queue_tells_exactly_how_little_comes_through():
    """A short one may be chance: nothing is decreased to less than half of it."""
    for delay, part in ((0.1, 0.5), (0.5, 0.5), (1.0, 0.25), (4.0, 0.095)):
        aimd = settled(0.9)
        aimd.decrease(10.0, 0.9, 0.1, delay)
        assert aimd.estimate == pytest.approx(part * 0.9)


def test_a_queue_that_still_stands_drains_longer():
    """At less, not for ever."""
    aimd = settled(0.9)
    aimd.decrease(10.0, 0.9, 1.0, 0.1)
    before = aimd.estimate
    for tenth in range(1, 30):
        aimd.extend_drain(10.0 + tenth / 10.0, 0.18)
    assert aimd.estimate == before
    assert 12.0 < aimd.drained_at < 12.6
    assert aimd.allowed(11.9) == pytest.approx((1.0 - 0.18 / 0.5) * before)
    aimd.decrease(20.0, 0.9, 1.0, 0.1)
    aimd.extend_drain(20.35, 1.5)
    assert aimd.allowed(20.4) == pytest.approx(0.35 * aimd.estimate)


def test_a_queue_is_outgrown_that_is_twice_as_long_as_what_was_sent_before_explains():
    """What waits already as a decrease is due is as much longer as little of it comes through."""
    aimd = Aimd(0.0, 0.05)
    assert aimd.outgrown(0.1)
    aimd.decrease(10.0, 0.2, 0.25, 0.1)
    assert not aimd.outgrown(0.8)
    assert aimd.outgrown(0.81)
    aimd.decrease(10.0, 0.2, 0.0, 0.1)
    assert not aimd.outgrown(4.0)


def test_while_nothing_tells_of_the_channel_little_is_sent():
    """Until something comes; then all of it again."""
    aimd = settled(0.5)
    aimd.hold_back(10.0)
    assert aimd.estimate == pytest.approx(0.5)
    assert aimd.allowed(10.1) == pytest.approx(0.35 * 0.5)
    assert aimd.allowed(aimd.drained_at) == pytest.approx(0.5)


def test_what_others_know_is_older_than_a_decrease():
    """Until nothing stood in the way for long, it grows no faster for what the others say."""
    aimd = settled(0.3)
    aimd.increase(2.0, 1.0, 1.0, 1.0)
    assert aimd.estimate == pytest.approx(0.3 + TUNING.increase)
    aimd.increase(8.0, 1.0, 1.0, 1.0)
    assert aimd.estimate == pytest.approx(1.5 * (0.3 + TUNING.increase))


@pytest.mark.parametrize(("deed", "words"), [("decrease", (0.2, 0.5, 0.1)), ("decrease_to", (0.2, 0.1)), ("decay", ())])
def test_what_decreases_it_speaks_against_more(deed, words):
    """Growth does not, and where it begins nothing does."""
    aimd = Aimd(0.0, 0.05)
    aimd.increase(1.0, 1.0, 1.0, 0.0)
    assert not aimd.bounded
    getattr(aimd, deed)(*(words if deed == "decay" else (2.0, *words)))
    assert aimd.bounded


@pytest.fixture
def limit():
    aimd = Aimd(0.0, AIR.least)
    aimd.restore(0.5)
    return AdaptiveLimit(0.0, 0, AIR, aimd)


def reports(leader="", **capacities):
    """Reports of robots on the limit, by name."""
    made = CapacityReports("us")
    for robot, capacity in capacities.items():
        made.note(0.0, Digest(robot, robot, 0.0, 0, 0, capacity=(capacity,)))
    made.set_leader(0.0, leader)
    return made


def test_a_new_limit_is_in_force_as_it_is_estimated(limit):
    """Nobody has said anything."""
    assert limit.in_force == limit.lasting == 0.5
    assert limit.objects


def test_the_least_of_our_estimate_and_the_reports_is_in_force(limit):
    """While nobody leads our estimate stays."""
    limit.combine(0.0, reports(op=0.3), ("op",), 0.0)
    assert limit.in_force == limit.others == 0.3
    assert limit.aimd.estimate == 0.5
    assert not limit.objects


def test_a_follower_takes_over_what_its_leader_reports(limit):
    """Where it is less."""
    limit.combine(0.0, reports("op", op=0.3), (), 0.0)
    assert limit.aimd.estimate == limit.lasting == 0.3


def test_a_leader_decreases_its_estimate_by_what_others_report(limit):
    """And drains the queue that it sees itself."""
    limit.combine(0.0, reports("us", op=0.3), ("op",), 0.2)
    assert limit.lasting == 0.3
    assert limit.in_force == pytest.approx(0.3 * 0.6)


def reported(**capacities):
    """Reports of robots, by name, all at once."""
    reports = CapacityReports("us")
    for robot, capacity in capacities.items():
        reports.note(0.0, Digest(robot, robot, 0.0, 0, 0, capacity=capacity))
    return reports


def test_without_a_leader_the_least_counts_but_not_that_of_a_single_one():
    """Unless it is the only one, or the only one that our samples go to; and only what is fresh."""
    reports = reported(a=(0.3,), b=(0.5,), c=(0.7,))
    assert reports.bound(1.0, 0, AIR, ()) == 0.5
    assert reports.bound(1.0, 0, AIR, ("a",)) == 0.3
    assert reports.least(1.0, 0) == 0.3
    assert reports.bound(TUNING.lifetime + 1.0, 0, AIR, ()) == 1.0
    assert reports.least(TUNING.lifetime + 1.0, 0) == 0.0
    reports.forget("b")
    assert reports.bound(1.0, 0, AIR, ()) == 0.7
    assert reports.bound(1.0, 1, AIR, ()) == 1.0


@given(st.lists(st.floats(-1.0, 2.0), max_size=5), st.booleans())
def test_whatever_is_told_stays_between_floor_and_ceiling(told, ours):
    """Of any robot."""
    reports = reported(**{f"r{i}": (part,) for i, part in enumerate(told)})
    assert AIR.least <= reports.bound(0.0, 0, AIR, ("r0", "r1") if ours else ()) <= 1.0


def test_who_follows_hears_the_leader_alone():
    """What it has in force, and how much all use."""
    reports = reported(a=(0.3,), op=(0.6, 0.4))
    reports.set_leader(0.1, "op")
    assert reports.follows
    assert not reports.leads
    assert reports.bound(0.1, 0, AIR, ("a",)) == 0.6
    assert reports.used(1) == (0.4,)
    assert reports.used(3) is None


def test_a_leader_that_has_said_nothing_for_long_is_followed_no_more():
    """Then all have a word."""
    reports = reported(op=(0.6, 0.4))
    reports.note(2.0 * TUNING.lifetime, Digest("a", "a", 2.0 * TUNING.lifetime, capacity=(0.3,)))
    reports.set_leader(2.0 * TUNING.lifetime, "op")
    assert not reports.follows
    assert reports.bound(2.0 * TUNING.lifetime, 0, AIR, ()) == 0.3


@pytest.mark.parametrize("leader", ["us", "unheard", ""])
def test_nobody_follows_itself_nor_whom_it_has_not_heard(leader):
    """Then all have a word."""
    reports = reported(a=(0.3,))
    reports.set_leader(0.0, leader)
    assert not reports.follows
    assert reports.leads is (leader == "us")
    assert reports.bound(0.0, 0, AIR, ()) == 0.3
    assert reports.used(1) is None
