"""What the next samples are expected to be worth."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.forecast.features import FeatureTrack, Outlook
from tests.utility_specs import outlooks
from utility_specs.forecast import AUTO, LAST, TREND, FeatureForecast, PythonMethod
from utility_specs.specs import Failures


def tracked(values, methods=AUTO):
    track = FeatureTrack(methods, Failures())
    for t, value in enumerate(values):
        track.note(float(t), float(value))
    return track


@pytest.mark.parametrize(
    ("values", "kind", "expected"),
    [
        (np.random.default_rng(1).normal(5.0, 1.0, 60), "mean", pytest.approx(5.0, abs=0.8)),
        (0.1 * np.arange(30), "trend", pytest.approx(3.0)),
        (np.cumsum(np.random.default_rng(2).normal(0.0, 1.0, 60)), "last", None),
        ([3.0] * 30, "last", 3.0),
        ([1.0, 2.0, 3.0], "last", 3.0),
    ],
)
def test_the_method_that_would_have_erred_least_is_chosen(values, kind, expected):
    """Noise around a mean, a steady rise, a random walk; in a tie, or of a young stream, the last value."""
    track = tracked(values)
    assert track.method.kind == kind
    assert expected is None or track.expect(float(len(values))) == expected


def test_the_choice_is_less_wrong_than_any_single_method_over_a_mission():
    """Its errors are within a few percent of the best method's on each of three kinds of feature."""
    rng = np.random.default_rng(3)
    missions = [rng.normal(0, 1, 300), np.cumsum(rng.normal(0, 1, 300)), np.arange(300.0) + rng.normal(0, 0.1, 300)]
    for values in missions:
        wrong = {}
        for name, methods in {"auto": AUTO, **{m.kind: (m,) for m in AUTO}}.items():
            track = FeatureTrack(methods, Failures())
            off = []
            for t, value in enumerate(values.tolist()):
                if t > 20:
                    off.append(abs(track.expect(float(t)) - value))
                track.note(float(t), value)
            wrong[name] = float(np.mean(off))
        auto = wrong.pop("auto")
        assert auto <= 1.1 * min(wrong.values())


def test_what_a_stream_is_like_may_change():
    """Old errors fade: the choice follows."""
    rising = (0.5 * np.arange(40)).tolist()
    track = tracked([*rising, *[rising[-1]] * 30])
    assert track.method.kind == "last"


def test_a_function_that_fails_is_counted_and_the_last_value_holds():
    """Nothing is raised on the way of a sample."""
    failures = Failures()
    track = FeatureTrack([PythonMethod("o:broken", outlooks.broken)], failures)
    track.note(0.0, 0.5)
    track.note(1.0, 7.0)
    assert track.expect(2.0) == 7.0
    assert failures.counts() == {"forecast": 1}


def test_features_are_forecast_each_by_its_own_method():
    """Others appear when a spec has changed: then the past is another one's."""
    outlook = Outlook(FeatureForecast((LAST,), {"red": (TREND,)}), Failures())
    for t in range(5):
        outlook.note(float(t), {"red": 0.1 * t, "size": float(t)})
    assert outlook.expect(5.0) == {"red": pytest.approx(0.5), "size": 4.0}
    assert (outlook.steady, outlook.chosen) == (False, {"red": "trend", "size": "last"})
    outlook.note(5.0, {"size": 1.0})
    assert (outlook.steady, outlook.chosen) == (True, {"size": "last"})


@given(st.lists(st.tuples(st.floats(-1.0, 10.0), st.floats(-1e9, 1e9)), min_size=1, max_size=60), st.floats(0.0, 1e4))
def test_whatever_is_noted_a_finite_value_is_expected(samples, ahead):
    """Times need not rise."""
    track, t = FeatureTrack(AUTO, Failures()), 0.0
    for step, value in samples:
        t += step
        track.note(t, value)
    assert math.isfinite(track.expect(t + ahead))
