"""Forecasts of features."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.errors import ProblemError
from tests.utility_specs import outlooks
from utility_specs.forecast import (
    AUTO,
    LAST,
    MEAN,
    TREND,
    FeatureForecast,
    PythonForecast,
    PythonMethod,
    forecast_of,
)

VALUES = st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=20)


def test_the_next_message_is_expected_to_resemble_the_last():
    """The newest value counts, whenever the next message comes."""
    assert LAST.predict([0.0, 1.0], [0.1, 0.3], 9.0) == 0.3


def test_a_mean_is_that_of_all_that_is_remembered():
    """Noise averages out."""
    assert MEAN.predict([0.0, 1.0, 2.0], [1.0, 2.0, 6.0], 9.0) == 3.0


def test_a_trend_goes_on_for_as_long_as_it_was_seen():
    """A line through the last values is followed; further ahead than it was seen nothing is claimed."""
    times, values = [0.0, 1.0, 2.0, 3.0], [1.0, 1.5, 2.0, 2.5]
    assert TREND.predict(times, values, 4.0) == pytest.approx(3.0)
    assert TREND.predict(times, values, 6.0) == TREND.predict(times, values, 99.0) == pytest.approx(4.0)


@given(VALUES)
def test_values_at_one_time_have_no_trend(values):
    """Where nothing says how fast they change, the last one holds."""
    assert TREND.predict([1.0] * len(values), values, 2.0) == values[-1]


def test_a_function_of_the_operators_forecasts():
    """It is asked with the past and the time; what is no finite number is an error."""
    assert PythonMethod("o:doubled", outlooks.doubled).predict([0.0], [3.0], 1.0) == 6.0
    with pytest.raises(ProblemError, match="o:endless returned inf, which is not finite"):
        PythonMethod("o:endless", outlooks.endless).predict([0.0], [3.0], 1.0)
    with pytest.raises(ProblemError, match="o:broken failed: ValueError: too much"):
        PythonMethod("o:broken", outlooks.broken).predict([0.0], [3.0], 1.0)
    with pytest.raises(ProblemError, match="o:leaving failed: SystemExit: no"):
        PythonMethod("o:leaving", outlooks.leaving).predict([0.0], [3.0], 1.0)
    with pytest.raises(ProblemError, match="o:cancelled failed: CancelledError: late"):
        PythonMethod("o:cancelled", outlooks.cancelled).predict([0.0], [3.0], 1.0)


def test_one_method_for_all_or_one_for_each_feature():
    """What a table leaves out is as the last one."""
    assert forecast_of("last").plain
    assert forecast_of("trend").of("red") == (TREND,)
    some = forecast_of({"red": "auto", "speed": PythonForecast(python="tests.utility_specs.outlooks:doubled")})
    assert some.of("red") == AUTO
    assert [each.kind for each in some.of("speed")] == ["python"]
    assert some.of("size") == (LAST,)
    assert not some.plain


@pytest.mark.parametrize(
    ("said", "kinds"),
    [
        ("mean", ["mean"]),
        ({"red": "trend"}, ["trend"]),
        ({"red": "trend", "speed": "mean"}, ["last", "mean", "trend"]),
        (PythonForecast(python="tests.utility_specs.outlooks:doubled"), ["last"]),
    ],
)
def test_a_scale_without_features_is_forecast_as_they_are(said, kinds):
    """By their method, where they have several by the best, and by no function that knows features only."""
    assert [each.kind for each in forecast_of(said).of_scale] == kinds


def test_unless_something_is_said_the_last_one_counts():
    """The default of a type is the paper's."""
    assert FeatureForecast().plain
