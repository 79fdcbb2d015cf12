"""Forecasts of features."""

from utility_specs.forecast import LastForecast, Observed


def test_the_next_message_is_expected_to_resemble_the_last():
    """The newest observation counts, whenever the next message comes."""
    history = [Observed(0.0, {"red": 0.1}), Observed(1.0, {"red": 0.3})]
    assert LastForecast().predict(history, 9.0) == {"red": 0.3}
    assert LastForecast().kind == "last"


def test_nothing_is_expected_of_an_unknown_stream():
    """Without history the defaults of the features hold."""
    assert LastForecast().predict([], 0.0) == {}
