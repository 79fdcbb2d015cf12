"""Following a rhythm."""

import pytest

from proxy.core.forecast.tracker import Tracker
from proxy.core.forecast.tuning import TUNING
from tests.proxy.core.streams import periodic


def followed(times, first=1):
    tracker = Tracker()
    for number, t in enumerate(times, first):
        tracker.observe(number, t)
    return tracker


def test_two_samples_off_their_time_change_nothing():
    """They may be outliers, however far they are off."""
    tracker = followed(periodic(20))
    before = tracker.rhythm
    tracker.observe(21, 25.4)
    tracker.observe(22, 25.7)
    assert tracker.rhythm == before
    tracker.observe(23, 27.0)
    assert tracker.rhythm.due(24) == pytest.approx(28.0)


def test_samples_without_anything_in_common_are_taken_in_at_last():
    """The stream is looser than it seemed."""
    tracker = followed(periodic(20))
    for number, off in enumerate([0.35, 0.95, 0.25, 0.9, 0.3] * 3, 21):
        tracker.observe(number, 4.0 + number + off)
        if number < 20 + TUNING.unlike:
            assert tracker.rhythm.looseness < 0.01
    assert tracker.rhythm.looseness > 0.1
    assert tracker.rhythm.period == pytest.approx(1.0, abs=0.1)


def test_after_a_pause_without_any_past_a_new_one_begins():
    """One sample alone has no rhythm."""
    tracker = Tracker()
    tracker.resume(5, 3.0)
    assert tracker.rhythm is None


def test_the_period_of_a_tight_rhythm_is_known_better_the_longer_it_lasts():
    """Forty-eight samples tell it five times as well as sixteen."""
    errors = {}
    for count in (16, 60):
        off = [followed(periodic(count, period=0.1, jitter=0.04, seed=seed)).rhythm.period - 0.1 for seed in range(40)]
        errors[count] = sum(abs(error) for error in off) / len(off)
    assert errors[60] < 0.35 * errors[16]


def test_what_the_last_samples_show_by_chance_does_not_hide_what_all_of_them_do():
    """Of many rhythms with a jitter of a twentieth nearly all are known from all their samples."""
    known = [followed(periodic(60, 0.1, jitter=0.005, seed=seed)).rhythm for seed in range(40)]
    assert sum(rhythm.known > TUNING.short_memory for rhythm in known) >= 36
    assert [rhythm.period for rhythm in known] == [pytest.approx(0.1, rel=3e-3)] * 40


def test_a_period_that_drifts_is_followed():
    """What is older than the rhythm holds is no evidence."""
    times, t = [], 0.0
    for k in range(120):
        t += 0.1 * (1.0 + 0.0005 * k)
        times.append(t)
    assert followed(times).rhythm.due(121) == pytest.approx(t + 0.1 * 1.06, abs=0.003)
