"""When streams generate."""

import math
import random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from proxy.core.forecast.rhythm import Rhythm
from proxy.core.forecast.schedule import Schedule
from proxy.core.forecast.tuning import TUNING
from tests.proxy.core.streams import bursts, errors, observe, periodic, poisson
from tests.utility_specs import outlooks
from utility_specs.schedules import PeriodicRule, PoissonRule, PythonRule, TimesRule
from utility_specs.specs import Failures


def ruled(rule, failures=None):
    schedule = Schedule()
    schedule.set_rule(rule, failures or Failures())
    return schedule


@given(st.floats(0.01, 60.0), st.floats(0.0, 1000.0), st.integers(3, 40))
def test_a_steady_stream_is_predicted_exactly(period, phase, count):
    """Without jitter the next generation times are those of the stream."""
    schedule = observe(Schedule(), [phase + k * period for k in range(count)])
    last = phase + (count - 1) * period
    expected = [last + period, last + 2 * period]
    assert schedule.forecast(last, last + 2.5 * period, 10) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("loss", [0.0, 0.1, 0.3])
@pytest.mark.parametrize("jitter", [0.0, 0.1])
def test_predicted_times_are_right_to_a_tenth_of_the_period(loss, jitter):
    """Whatever is lost, with and without numbers, for the next three samples; 0.067 is what jitter alone makes."""
    found = [errors(periodic(120, jitter=jitter, seed=s), loss=loss, seed=s) for s in range(8)]
    assert np.median(np.concatenate(found)) <= (0.085 if jitter else 1e-6)
    assert np.quantile(np.concatenate(found), 0.95) <= (0.28 if jitter else 1e-6)


@pytest.mark.parametrize(("before", "after"), [(1.0, 1 / 3), (0.1, 0.25), (1.0, 2.0)])
def test_a_change_of_rate_is_followed_within_three_periods(before, after):
    """Longer gaps are losses until three of them say the same."""
    old = periodic(40, before)
    new = [old[-1] + k * after for k in range(1, 4)]
    schedule = observe(Schedule(), [*old, *new])
    assert schedule.period == pytest.approx(after)
    assert schedule.forecast(new[-1], new[-1] + 1.5 * after, 5) == pytest.approx([new[-1] + after])


@pytest.mark.parametrize(("before", "after"), [(1.0, 1 / 3), (0.1, 0.25), (1.0, 2.0)])
def test_a_change_of_rate_is_followed_through_jitter_and_loss(before, after):
    """With numbers, the median of many streams is right after four samples."""
    late = []
    for seed in range(20):
        old = periodic(40, before, 0.1, seed)
        new = periodic(12, after, 0.1, seed + 50, start=old[-1] + after)
        schedule, last = observe(Schedule(), old, loss=0.1, seed=seed), 0
        for at, t in enumerate(new):
            schedule.observe(41 + at, t)
            last = last if abs(schedule.period - after) < 0.15 * after else at + 1
        late.append(last)
    assert np.median(late) <= 4


@pytest.mark.parametrize("phase", [0.0, 0.001, 0.5, 0.999])
def test_the_phase_is_right_even_where_it_lies_near_zero(phase):
    """Jitter around a phase of 0 does not predict half a period wrong: numbers put times on the circle."""
    schedule = observe(Schedule(), periodic(40, jitter=0.1, seed=3, start=phase))
    predicted = schedule.forecast(40.0 + phase - 0.5, 40.0 + phase + 0.5, 3)
    assert len(predicted) == 1
    assert abs(predicted[0] - (40.0 + phase)) < 0.15


def test_samples_that_were_not_seen_do_not_stretch_the_period():
    """The period comes from counts, so a gap of three samples spans three periods."""
    schedule = Schedule()
    for count in (1, 2, 5, 6, 9, 10):
        schedule.observe(count, 0.2 * count)
    assert schedule.period == pytest.approx(0.2)


def test_one_late_sample_moves_nothing():
    """A sample 40 % late is an outlier, and the next ones are expected where they were."""
    times = periodic(30)
    schedule = observe(Schedule(), [*times[:20], times[20] + 0.4, *times[21:22]])
    assert schedule.forecast(times[21], times[21] + 1.5, 5) == pytest.approx([times[22]], abs=1e-3)
    assert schedule.jitter < 0.01


@pytest.mark.parametrize("wrong", [-3.0, 0.7, 2.3])
def test_a_wrong_timestamp_hardly_matters(wrong):
    """One far in the past is ignored, one in the future gives way to the next sample that comes when it was due."""
    times = periodic(30)
    schedule = observe(Schedule(), [*times[:20], times[20] + wrong, *times[21:]])
    assert schedule.forecast(times[-1], times[-1] + 1.5, 5) == pytest.approx([times[-1] + 1.0], abs=1e-3)


@pytest.mark.parametrize("shift", [0.3, 0.5, 0.8])
def test_a_jump_of_the_phase_is_followed(shift):
    """An app that restarts keeps its period; after three samples the phase is the new one."""
    times = periodic(20)
    schedule = observe(Schedule(), [*times, *[times[-1] + shift + k for k in range(1, 4)]])
    last = times[-1] + shift + 3
    assert schedule.forecast(last, last + 1.5, 5) == pytest.approx([last + 1.0], abs=0.02)
    assert schedule.period == pytest.approx(1.0, rel=0.01)


def test_a_stream_that_goes_on_after_a_pause_has_its_period_at_once():
    """Its phase is that of the first sample after the pause."""
    schedule = observe(Schedule(), [*periodic(20, 0.1), 99.0])
    assert schedule.forecast(99.0, 99.15, 5) == pytest.approx([99.1])


def test_a_clock_that_was_set_back_is_believed_in_the_end():
    """Three samples in a row before the last one begin a new past."""
    schedule = observe(Schedule(), periodic(20, start=100.0))
    observe(schedule, periodic(8, start=10.5), first=21)
    assert schedule.last == pytest.approx(17.5)
    assert schedule.forecast(17.5, 18.6, 5) == pytest.approx([18.5])


def test_a_stream_that_paces_itself_is_expected_from_its_last_sample():
    """Where deviations add up, as with an app that sleeps for a period, the last time tells more than a grid."""
    steps = 1.0 + np.random.default_rng(1).normal(0.0, 0.1, 300)
    found = errors(np.cumsum(steps).tolist(), loss=0.0, ahead=1)
    assert np.median(found) < 0.085


def test_of_a_random_stream_only_the_rate_is_known():
    """The next sample is expected one mean interval from now, however long ago the last one was."""
    times = poisson(200, 2.0, seed=1)
    schedule = observe(Schedule(), times)
    assert schedule.kind == "poisson"
    assert schedule.period == schedule.jitter == pytest.approx(2.0, rel=0.3)
    for now in (times[-1], times[-1] + 3.3):
        (first,) = schedule.forecast(times[-1], now + 1.5 * schedule.period, 5, now)
        assert first == pytest.approx(now + schedule.period)


def test_random_streams_seldom_seem_to_have_a_rhythm():
    """Without numbers it takes little chance to find one."""
    kinds = []
    for seed in range(8):
        schedule = Schedule()
        for at, t in enumerate(poisson(150, seed=seed)):
            schedule.observe(at + 1, t)
            kinds += [schedule.kind == "poisson"] if at > 12 else []
    assert np.mean(kinds) >= 0.9


@pytest.mark.parametrize("jitter", [0.0, 0.1, 0.15])
def test_jitter_does_not_make_a_stream_random(jitter):
    """A periodic stream is recognised as one, and its jitter told."""
    schedule = observe(Schedule(), periodic(60, jitter=jitter, seed=2))
    assert schedule.kind == "periodic"
    assert schedule.jitter == pytest.approx(jitter, rel=0.5, abs=1e-6)


@pytest.mark.parametrize("loss", [0.0, 0.3])
def test_bursts_are_expected_as_such(loss):
    """The members still missing of the last one, a pause, and the next one."""
    schedule = observe(Schedule(), bursts(12, jitter=0.02), loss=loss, seed=4)
    assert schedule.kind.split()[0] == "bursts"
    forecast = [t for t in schedule.forecast(24.5, 27.5, 50) if t > 25.0]
    assert min(forecast) == pytest.approx(26.0, abs=0.1)
    assert len(forecast) == (5 if loss == 0.0 else pytest.approx(5, abs=2))
    assert max(forecast) < 26.0 + 0.4


def test_the_rest_of_a_burst_that_has_begun_is_expected():
    """Two of five members came."""
    times = bursts(8)
    schedule = observe(Schedule(), [*times, 16.0, 16.05])
    assert schedule.forecast(16.05, 17.0, 50) == pytest.approx([16.1, 16.15, 16.2])


def test_bursts_at_random_moments_are_expected_from_now_on():
    """Their spacing is a mean, their members are as regular as ever."""
    starts = poisson(40, 10.0, seed=3)
    schedule = observe(Schedule(), [t + 0.05 * i for t in starts for i in range(4)])
    forecast = schedule.forecast(starts[-1] + 1.0, starts[-1] + 40.0, 4, starts[-1] + 3.0)
    assert np.diff(forecast) == pytest.approx(0.05)
    assert forecast[0] == pytest.approx(starts[-1] + 3.0 + 4 * schedule.period)


def test_one_sample_predicts_nothing():
    """A period is not invented from a single generation time."""
    schedule = Schedule()
    assert schedule.forecast(0.0, 10.0, 5) == []
    assert (schedule.kind, schedule.period, schedule.jitter) == ("", 0.0, 0.0)
    assert schedule.over(0.0)
    schedule.observe(1, 1.0)
    assert schedule.forecast(1.0, 10.0, 5) == []
    assert not schedule.over(1.0 + TUNING.lone_timeout / 2)
    assert schedule.over(1.0 + TUNING.lone_timeout)


@pytest.mark.parametrize(("period", "silence", "over"), [(0.1, 0.9, False), (0.1, 2.0, True), (100.0, 390.0, False)])
def test_a_stream_is_over_by_its_own_measure(period, silence, over):
    """A camera that is silent for 2 s has stopped, a thermometer has not."""
    times = periodic(20, period)
    assert observe(Schedule(), times).over(times[-1] + silence) is over


def test_what_is_heard_of_seldom_is_over_by_its_period():
    """A fast stream whose robot tells of it once in ten seconds: until when that told is known."""
    schedule = Schedule()
    for k in range(1, 20):
        schedule.observe(40 * k, 10.0 * k)
    assert not schedule.over(191.4)
    assert schedule.over(191.5)


def test_what_comes_at_random_may_be_silent_for_longer():
    """Of the gaps of a rhythm none is as long as four periods, of random ones each fiftieth."""
    schedule = Schedule()
    schedule.assume(1.0, "poisson")
    schedule.observe(1, 0.0)
    assert not schedule.over(8.9)
    assert schedule.over(9.1)


def test_a_pause_does_not_slow_down_what_comes_at_random():
    """It is none of the gaps that tell how often samples come."""
    times = poisson(30, seed=1)
    before, after = observe(Schedule(), times), Schedule()
    observe(after, [*times, *(t + times[-1] + 100.0 * before.period for t in times[:5])])
    assert (before.kind, after.kind) == ("poisson", "poisson")
    assert after.period < 1.5 * before.period


def test_it_is_known_when_a_stream_began_again():
    """The first sample after a pause; the first of all is none."""
    schedule = observe(Schedule(), periodic(20, 0.5))
    assert schedule.resumed == -math.inf
    last = schedule.last
    schedule.observe(21, last + 1.5)
    assert schedule.resumed == -math.inf
    schedule.observe(22, last + 10.0)
    schedule.observe(23, last + 10.5)
    assert schedule.resumed == last + 10.0


def test_a_burst_is_not_over_between_two():
    """Its pauses belong to it."""
    assert not observe(Schedule(), bursts(10, spacing=5.0)).over(52.0)
    assert observe(Schedule(), bursts(10, spacing=5.0)).over(61.0)


def test_a_period_reported_by_another_robot_serves_until_one_is_seen():
    """An assumed period is used at once and replaced by the estimate."""
    schedule = Schedule()
    schedule.observe(1, 1.0)
    for nonsense in (0.0, -1.0, math.nan, math.inf):
        schedule.assume(nonsense)
    assert schedule.period == 0.0
    schedule.assume(0.5)
    assert schedule.forecast(1.0, 2.1, 5) == pytest.approx([1.5, 2.0])
    for count in (2, 3, 4):
        schedule.observe(count, 1.0 + 0.4 * (count - 1))
    assert schedule.period == pytest.approx(0.4)


def test_another_period_reported_ends_what_was_seen_before():
    """Its robot sees every sample, and saw the rate change before we could."""
    schedule = observe(Schedule(), periodic(20))
    schedule.assume(0.25, "periodic")
    assert schedule.forecast(24.0, 24.6, 5) == pytest.approx([24.25, 24.5])
    observe(schedule, periodic(10, 0.5, start=24.5), first=21)
    assert schedule.period == pytest.approx(0.5)


def test_what_kind_of_stream_it_is_its_robot_knows():
    """Few samples of a random stream may seem regular, and those of bursts may all be first ones."""
    schedule = observe(Schedule(), periodic(20))
    schedule.assume(3.0, "poisson")
    assert schedule.forecast(24.0, 31.0, 5, 25.0) == pytest.approx([28.0, 31.0])
    for nonsense in ("bursts", "bursts x y", "bursts 0 1", "bursts 5 9"):
        schedule.assume(0.2, nonsense)
        assert schedule.kind == "periodic"
    schedule.assume(0.2, "bursts 5 0.05")
    assert schedule.forecast(24.5, 25.3, 9) == pytest.approx([24.8, 24.85, 24.9, 24.95, 25.0])
    schedule.assume(1.0, "periodic")
    assert schedule.kind == "periodic"


def test_the_rhythm_that_its_robot_reports_holds():
    """Whatever a few samples seem to tell, and from where it says; without one, what is seen counts again."""
    schedule = observe(Schedule(), [0.0, 1.3, 1.9, 3.2, 4.1])
    assert schedule.rhythm.jitter > 0.0
    schedule.observe(8, 7.1, Rhythm(1.0, 7.0, 8, 0.1, 16))
    assert schedule.rhythm == Rhythm(1.0, 7.0, 8, 0.1, 16)
    assert schedule.forecast(7.1, 9.5, 5) == pytest.approx([8.0, 9.0])
    schedule.observe(9, 7.05, Rhythm(1.0, 7.0, 9, 0.1, 16))
    assert schedule.last == 7.05
    schedule.observe(29, 99.0, Rhythm(2.0, 99.0, 29, 0.0, 16))
    assert schedule.forecast(99.0, 101.5, 5) == pytest.approx([101.0])
    schedule.assume(3.0, "poisson")
    assert schedule.kind == "periodic"
    schedule.observe(30, 101.1)
    assert (schedule.kind, schedule.rhythm) == ("poisson", None)


def test_old_news_changes_nothing():
    """Counts and times only go forward."""
    schedule = observe(Schedule(), [0.0, 1.0, 2.0, 3.0, 4.0])
    before = schedule.forecast(4.0, 8.0, 5)
    schedule.observe(3, 2.5)
    schedule.observe(6, 1.0)
    assert schedule.forecast(4.0, 8.0, 5) == before


def test_a_written_period_holds_whatever_is_seen():
    """The phase comes from the samples unless it is written, too."""
    seen = [0.03, 2.01, 2.98, 6.0, 6.5]
    assert observe(ruled(PeriodicRule(1.0)), seen).forecast(6.4, 8.2, 5) == pytest.approx([7.0, 8.0], abs=0.05)
    shifted = observe(ruled(PeriodicRule(1.0, 0.25)), seen)
    assert shifted.forecast(6.4, 8.5, 5) == pytest.approx([7.28, 8.28])
    assert shifted.period == 1.0


def test_a_written_rate_holds_whatever_is_seen():
    """The next is expected from now on."""
    schedule = observe(ruled(PoissonRule(4.0)), periodic(20))
    assert schedule.kind == "poisson"
    assert schedule.forecast(24.0, 40.0, 2, 26.0) == [30.0, 34.0]


def test_listed_times_are_counted_from_the_first_sample():
    """Again and again, or once; a sample that comes a little late is not expected again."""
    schedule = ruled(TimesRule((0.0, 1.0, 5.0), 10.0))
    observe(schedule, [100.0, 101.02])
    assert schedule.forecast(101.02, 112.0, 9) == pytest.approx([105.01, 110.01, 111.01])
    assert schedule.kind == "times"
    assert schedule.period == pytest.approx(10.0 / 3.0)
    once = observe(ruled(TimesRule((0.0, 1.0, 5.0))), [100.0, 101.0])
    assert once.forecast(101.0, 200.0, 9) == [105.0]
    assert (once.period, once.jitter) == (2.5, 0.0)
    once.observe(3, 105.0)
    assert once.forecast(105.0, 200.0, 9) == []
    assert once.over(131.0)


def test_who_comes_later_finds_its_place_in_the_list_by_number():
    """The fifth sample is the second one of the second round; the list of a stream that went on too long is over."""
    schedule = ruled(TimesRule((0.0, 1.0, 5.0), 10.0))
    schedule.observe(5, 211.0)
    assert schedule.forecast(211.0, 221.0, 9) == [215.0, 220.0, 221.0]
    beyond = ruled(TimesRule((0.0, 1.0)))
    beyond.observe(5, 211.0)
    assert beyond.forecast(212.5, 300.0, 9) == []


def test_a_function_of_the_operators_says_when():
    """It is asked once after each sample, with the times since the first one."""
    asked = []

    def function(times, until):
        asked.append((times, until))
        return [times[-1] + 2.0]

    schedule = observe(ruled(PythonRule("mission:times", function)), [100.0, 101.0])
    assert schedule.forecast(101.0, 111.0, 9) == [103.0]
    assert schedule.forecast(102.0, 112.0, 9, 102.0) == [103.0]
    assert asked == [([0.0, 1.0], 21.0)]
    assert (schedule.kind, schedule.period) == ("python", pytest.approx(1.0))
    schedule.observe(3, 103.0)
    assert schedule.forecast(103.0, 113.0, 9) == [105.0]


def test_of_one_sample_a_function_may_expect_the_next_one_as_late_as_others_do():
    """Its stream has no period yet by which it could be over."""
    schedule = observe(ruled(PythonRule("mission:times", lambda times, _: [times[-1] + 5.0])), [100.0])
    assert schedule.forecast(100.0, 111.0, 9) == [105.0]
    assert not schedule.over(106.0)
    assert schedule.over(100.0 + TUNING.lone_timeout)


def test_a_function_that_fails_in_flight_is_counted():
    """Then nothing is expected of the stream."""
    failures = Failures()
    rule = PythonRule("mission:times", outlooks.two_then_nothing)
    schedule = observe(ruled(rule, failures), [1.0, 2.0])
    assert schedule.forecast(2.0, 5.0, 9) == [4.0]
    observe(schedule, [3.0, 4.0], first=3)
    assert schedule.forecast(4.0, 9.0, 9) == schedule.forecast(4.0, 9.0, 9) == []
    assert failures.counts() == {"schedule": 1}


def test_a_rule_may_come_and_go():
    """What was seen is kept."""
    schedule = observe(Schedule(), periodic(20))
    schedule.set_rule(PoissonRule(4.0), Failures())
    assert schedule.kind == "poisson"
    schedule.set_rule(None, Failures())
    assert (schedule.kind, schedule.period) == ("periodic", pytest.approx(1.0))


EVENTS = st.lists(st.tuples(st.integers(0, 5), st.floats(-2.0, 20.0)), max_size=80)


@hypothesis_settings(max_examples=60)
@given(EVENTS, st.integers(0, 30), st.floats(0.0, 50.0))
def test_whatever_is_seen_forecasts_are_in_order_and_bounded(events, most, ahead):
    """Any counts and times: a forecast holds at most what was asked for, within what was asked."""
    schedule, count, t = Schedule(), 0, 100.0
    for step, gap in events:
        count, t = count + step, t + gap
        schedule.observe(count, t)
        times = schedule.forecast(t, t + ahead, most, t + ahead / 2)
        assert len(times) <= most
        assert times == sorted(times)
        assert all(t < at <= t + ahead for at in times)
        assert math.isfinite(schedule.period)
        assert schedule.period >= 0.0
        assert schedule.jitter >= 0.0


@pytest.mark.parametrize("seed", range(4))
def test_a_stream_of_which_most_samples_are_superseded_keeps_a_period(seed):
    """Publications come twenty at once and at odd times, and of most of them the last one alone is seen."""
    rng = random.Random(seed)
    schedule, count, t = Schedule(), 0, 100.0
    for _ in range(100):
        count, t = count + rng.choice([1, 19, 20, 20, 20]), t + rng.lognormvariate(-5.0, 1.0)
        schedule.observe(count, t)
        assert len(schedule.forecast(t, t + 60.0, 60, t)) <= 60
        assert schedule.period >= 0.0


@pytest.mark.parametrize("kind", ["", "periodic", "poisson", "bursts 2 1e-31"])
def test_a_period_that_no_clock_can_tell_is_not_believed(kind):
    """Whoever tells it, forecasts come to an end."""
    schedule = Schedule()
    assert not schedule.assume(1e-30, kind)
    schedule.observe(5, 100.1)
    assert schedule.forecast(100.3, 160.3, 60, 100.3) == []


def test_end_and_next_sample_are_known_at_a_look():
    """As they are asked for one by one; without a period nothing is due."""
    schedule = Schedule()
    assert schedule.prospect() == (-math.inf, math.inf)
    for count in range(1, 9):
        schedule.observe(count, 0.5 * count)
    assert schedule.prospect() == (schedule.over_at, pytest.approx(4.5))
    schedule.observe(9, 4.5)
    assert schedule.prospect() == (schedule.over_at, pytest.approx(5.0))
