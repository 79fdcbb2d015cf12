"""Quantities as text."""

import pytest

from proxy.quantities import amount, duration, rate, schedule, share


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (None, "-"),
        (0.0, "0 ms"),
        (0.0125, "12.5 ms"),
        (-0.5, "-500 ms"),
        (1.5, "1.5 s"),
        (61.0, "1 min 1 s"),
        (7260.0, "2 h 1 min"),
        (3599.9997, "1 h 0 min"),
        (-61.0, "-1 min 1 s"),
        (float("nan"), "-"),
        (float("-inf"), "-"),
    ],
)
def test_durations_have_units_that_suit(seconds, text):
    """Milliseconds below a second, minutes and hours above a minute."""
    assert duration(seconds) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "-"), (0, "0 B"), (999, "999 B"), (1000, "1 kB"), (2.5e6, "2.5 MB"), (3e9, "3 GB")],
)
def test_amounts_have_prefixes(value, text):
    """Three digits are enough."""
    assert amount(value, "B") == text


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.2, "s", "200 ms"),
        (0.00025, "s", "250 μs"),
        (0, "J", "0 J"),
        (0.0015, "J", "1.5 mJ"),
        (12.5, "J", "12.5 J"),
        (9.8, "messages", "9.8 messages"),
    ],
)
def test_amounts_of_small_units_have_small_prefixes(value, unit, text):
    """Airtime and energy come in thousandths, messages as they are."""
    assert amount(value, unit) == text


def test_shares_and_rates_need_something_to_divide_by():
    """What is not known is a dash, not a zero."""
    assert share(1.0, 4.0) == "25%"
    assert share(1.0, None) == share(None, 1.0) == "-"
    assert rate({"period": 0.5, "generated": 10, "forwarded": 5}) == "1"
    assert rate({"period": 0.0, "generated": 10, "forwarded": 5}) == "-"
    assert rate({"period": 0.5, "generated": 10, "forwarded": 5, "over": True}) == "0"


def test_a_schedule_says_how_exactly_it_is_kept():
    """Where there is a period to keep; other kinds are told by name alone."""
    assert schedule({"schedule": "periodic", "period": 0.5, "jitter": 0.05}) == "periodic ±10%"
    assert schedule({"schedule": "bursts 5 0.05", "period": 0.4, "jitter": 0.1}) == "bursts of 5"
    assert schedule({"schedule": "periodic", "period": 0.5, "jitter": 0.05, "over": True}) == "over"
    assert schedule({"schedule": "", "period": 0.0, "jitter": 0.0}) == schedule({}) == "-"
