"""An estimate grows by addition, decreases by multiplication, and stays between floor and ceiling."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.congestion.aimd import INITIAL, QUIET, STEP, Estimate

DEEDS = st.lists(
    st.one_of(
        st.tuples(st.just("grow"), st.floats(0.0, 5.0), st.floats(0.0, 2.0), st.floats(0.0, 1.0)),
        st.tuples(st.just("cut"), st.floats(0.0, 1.0), st.floats(0.0, 1.0), st.floats(0.0, 10.0)),
        st.tuples(st.just("fade")),
        st.tuples(st.just("wait")),
        st.tuples(st.just("heed"), st.floats(0.0, 2.0), st.floats(0.0, 10.0)),
        st.tuples(st.just("hold")),
        st.tuples(st.just("linger"), st.floats(0.0, 5.0)),
        st.tuples(st.just("restore"), st.floats(0.0, 2.0)),
    ),
    max_size=50,
)


@given(st.floats(0.001, 0.99), DEEDS)
def test_it_stays_between_floor_and_ceiling(floor, deeds):
    """Whatever happens; growth never lowers it, and nothing else but the end of a trial raises it."""
    estimate, now = Estimate(0.0, floor), 0.0
    for name, *words in deeds:
        now += 0.3
        before = estimate.part
        getattr(estimate, name)(
            *([now, *words] if name in ("grow", "cut", "linger", "wait", "heed", "hold") else words)
        )
        assert floor <= estimate.told(now) <= estimate.part <= 1.0
        assert (estimate.part >= before) if name in ("grow", "restore") else (estimate.part <= before)
        assert name not in ("cut", "heed") or estimate.settled_at >= estimate.drained_at


@given(st.floats(0.001, 0.99), st.floats(0.0, 1.0), st.booleans())
def test_a_follower_takes_over_what_it_agrees_with_and_what_is_less(floor, word, agrees):
    """Never less than the floor."""
    estimate = Estimate(0.0, floor)
    before = estimate.part
    estimate.follow(word, agrees=agrees)
    assert estimate.part == max(floor, word if agrees else min(before, word))


def settled(part=0.5):
    """An estimate of so much that was cut once, long ago."""
    estimate = Estimate(0.0, 0.05)
    estimate.restore(part / 0.9)
    estimate.cut(1.0, 1.0, 1.0, 0.1)
    assert estimate.part == pytest.approx(part)
    return estimate


def test_it_grows_by_addition_once_it_was_cut():
    """By as much each second, more the longer nothing stands in its way; before, and up to what others know, fast."""
    estimate = settled()
    estimate.grow(2.0, 1.0, 1.0, 0.1)
    assert estimate.part == pytest.approx(0.5 + STEP)
    estimate.grow(1.0 + QUIET + 2.0, 1.0, 1.0, 0.1)
    assert estimate.part == pytest.approx(0.5 + 4 * STEP)
    estimate.grow(9.0, 0.1, 1.0, 0.0)
    assert estimate.part == pytest.approx(0.5 + 4.1 * STEP)
    estimate.grow(10.0, 1.0, 1.0, 0.8)
    assert estimate.part == pytest.approx(1.5 * (0.5 + 4.1 * STEP))
    first = Estimate(0.0, 0.05)
    first.grow(1.0, 1.0, 1.0, 0.0)
    assert first.part == pytest.approx(1.5 * INITIAL)


def test_it_does_not_grow_beyond_what_is_tested():
    """Nor shrinks to it."""
    estimate = settled()
    estimate.grow(2.0, 1.0, 0.51, 0.0)
    assert estimate.part == pytest.approx(0.51)
    estimate.grow(3.0, 1.0, 0.3, 0.0)
    assert estimate.part == pytest.approx(0.51)


def test_a_cut_goes_to_what_came_through_and_lower_until_the_queue_has_drained():
    """Half of 0.8 came through and 0.2 s wait: less for half a second, a little below half of it from then on."""
    estimate = settled(0.9)
    estimate.cut(10.0, 0.8, 0.5, 0.2)
    assert estimate.part == pytest.approx(0.4)
    assert estimate.told(10.1) == pytest.approx(0.6 * 0.4)
    assert estimate.told(estimate.drained_at) == pytest.approx(0.4)
    assert estimate.drained_at == pytest.approx(10.5)


def test_a_cut_that_did_not_help_is_followed_by_a_deeper_one():
    """A full queue does not grow: nothing tells how much comes through."""
    estimate = settled(0.9)
    estimate.cut(10.0, 0.9, 1.0, 0.1)
    assert estimate.part == pytest.approx(0.9 * 0.9)
    estimate.cut(estimate.settled_at + 0.1, 0.9, 1.0, 0.1)
    assert estimate.part == pytest.approx(0.9 * 0.9 * 0.7)


def test_after_silence_it_may_grow_fast():
    """Nothing is known of the channel then."""
    estimate = settled()
    estimate.fade()
    assert estimate.part == pytest.approx(0.35)
    estimate.grow(2.0, 1.0, 1.0, 0.0)
    assert estimate.part == pytest.approx(0.35 * 1.5)
    estimate.wait(5.0)
    assert estimate.settled_at > 5.0


def test_a_queue_that_still_stands_drains_longer():
    """At less, not for ever; and one that has doubled meanwhile is reason for one other decrease."""
    estimate = settled(0.9)
    estimate.cut(10.0, 0.9, 1.0, 0.1)
    before = estimate.part
    for tenth in range(1, 30):
        estimate.linger(10.0 + tenth / 10.0, 0.18)
    assert estimate.part == before
    assert 12.0 < estimate.drained_at < 12.6
    assert estimate.told(11.9) == pytest.approx((1.0 - 0.18 / 0.5) * before)
    estimate.cut(20.0, 0.9, 1.0, 0.1)
    before = estimate.part
    estimate.linger(20.2, 0.5)
    estimate.linger(20.3, 0.5)
    assert estimate.part == pytest.approx(0.7 * before)
    estimate.linger(20.35, 1.5)
    assert estimate.part == pytest.approx(0.7 * before)
    assert estimate.told(20.4) == pytest.approx(0.35 * estimate.part)


def test_while_nothing_tells_of_the_channel_little_is_sent():
    """Until something comes; then all of it again."""
    estimate = settled(0.5)
    estimate.hold(10.0)
    assert estimate.part == pytest.approx(0.5)
    assert estimate.told(10.1) == pytest.approx(0.35 * 0.5)
    assert estimate.told(estimate.drained_at) == pytest.approx(0.5)


def test_what_others_know_is_older_than_a_decrease():
    """Until nothing stood in the way for long, it grows no faster for what the others say."""
    estimate = settled(0.3)
    estimate.grow(2.0, 1.0, 1.0, 1.0)
    assert estimate.part == pytest.approx(0.3 + STEP)
    estimate.grow(8.0, 1.0, 1.0, 1.0)
    assert estimate.part == pytest.approx(1.5 * (0.3 + STEP))


@pytest.mark.parametrize(("deed", "words"), [("cut", (0.2, 0.5, 0.1)), ("heed", (0.2, 0.1)), ("fade", ())])
def test_what_decreases_it_speaks_against_more(deed, words):
    """Growth does not, and where it begins nothing does."""
    estimate = Estimate(0.0, 0.05)
    estimate.grow(1.0, 1.0, 1.0, 0.0)
    assert not estimate.bounded
    getattr(estimate, deed)(*(words if deed == "fade" else (2.0, *words)))
    assert estimate.bounded
