"""Numbers, quantities and texts as people write them."""

import math
import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from utility_specs.learning import toml_text
from utility_specs.units import DURATION, RATE


@given(st.text())
def test_any_text_is_a_string(text):
    """And is read back as it was."""
    assert tomllib.loads(f"x = {toml_text.toml_string(text)}")["x"] == text


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_any_number_is_one(value):
    """About the same, with some digits."""
    read = tomllib.loads(f"x = {toml_text.number(value)}")["x"]
    assert read == pytest.approx(value, rel=0.006) or math.isinf(read * 1.01)


@given(st.floats(1e-5, 1e7))
def test_any_duration_is_one(seconds):
    """About the same, with two digits."""
    assert DURATION.parse(toml_text.duration(seconds)) == pytest.approx(seconds, rel=0.06)


@given(st.floats(0.0, 1e12))
def test_any_rate_is_rounded_up(speed):
    """To a rate that can be written, at most by half."""
    up = toml_text.rounded_up(speed)
    assert max(125.0, speed) * 0.999 <= up <= max(125.0, speed * 1.5)
    assert RATE.parse(toml_text.rate(up)) == pytest.approx(up)


@pytest.mark.parametrize(
    ("written", "text"),
    [
        (toml_text.number(0.83), "0.83"),
        (toml_text.number(12.0), "12"),
        (toml_text.number(-0.00012345), "-0.000123"),
        (toml_text.number(1.7e18), "1.7e+18"),
        (toml_text.duration(0.2), "200 ms"),
        (toml_text.duration(0.000012), "12 us"),
        (toml_text.duration(59.9), "1 min"),
        (toml_text.duration(7200.0), "2 h"),
        (toml_text.frequency(4.98), "5 Hz"),
        (toml_text.frequency(0.2), "every 5 s"),
        (toml_text.span(12.871, 12.899), "12.87 to 12.9"),
        (toml_text.span(1.0, 1.0), "1 to 1"),
        (toml_text.size(999), "999 B"),
        (toml_text.size(41_000), "41 kB"),
        (toml_text.rate(125.0), "1 kbit/s"),
        (toml_text.rate(1.0), "8 bit/s"),
        (toml_text.counted(1, "copy", "copies"), "1 copy"),
        (toml_text.counted(2, "copy", "copies"), "2 copies"),
        (toml_text.counted(2, "sample"), "2 samples"),
    ],
)
def test_they_look_as_people_write_them(written, text):
    """No more digits than count."""
    assert written == text


def test_comments_stand_below_each_other():
    """Behind values, or as lines of their own."""
    assert toml_text.commented("a = 1", "why").index("# why") == toml_text.commented("bb = 2", "why").index("# why")
    assert toml_text.commented("x" * 60, "why").endswith("x  # why")
    assert all(line.startswith("# ") and len(line) <= 120 for line in toml_text.prose("word " * 100))
