"""Quantities with units."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel

from utility_specs.errors import QuantityError
from utility_specs.units import AGE, DURATION, FRACTION, JOULE, RATE, SIZE, Duration, Fraction, Joule, Rate, Size


@pytest.mark.parametrize(
    ("dimension", "written", "base"),
    [
        (RATE, "2 Mbit/s", 250_000.0),
        (RATE, "1 kbit/s", 125.0),
        (RATE, "8bit/s", 1.0),
        (RATE, "250 kB/s", 250_000.0),
        (RATE, "1 KiB/s", 1024.0),
        (RATE, " 1_000.5  B/s ", 1000.5),
        (RATE, "1e-3 Gbit/s", 125_000.0),
        (SIZE, "50 kB", 50_000.0),
        (SIZE, "1 MiB", 1_048_576.0),
        (DURATION, "200 ms", 0.2),
        (DURATION, "33 µs", 33e-6),
        (DURATION, "2 min", 120.0),
        (DURATION, "0.5", 0.5),
        (DURATION, 3, 3.0),
        (DURATION, 0.25, 0.25),
        (FRACTION, "40 %", 0.4),
        (FRACTION, "100%", 1.0),
        (FRACTION, 0.4, 0.4),
        (FRACTION, 1, 1.0),
        (JOULE, "0.5 J", 0.5),
        (JOULE, "2 uJ", 2e-6),
        (JOULE, "2 µJ", 2e-6),
        (JOULE, "1 mWh", 3.6),
        (AGE, "0 s", 0.0),
        (AGE, 0, 0.0),
        (AGE, "200 ms", 0.2),
    ],
)
def test_a_quantity_is_read_into_its_base_unit(dimension, written, base):
    """Prefixes are decimal, 8 bit are a byte, plain durations are seconds."""
    assert math.isclose(dimension.parse(written), base, rel_tol=1e-12)


@pytest.mark.parametrize(
    ("dimension", "written", "message"),
    [
        (RATE, 2_000_000, 'needs a unit; write for example "2 Mbit/s"'),
        (RATE, "2", 'needs a unit; write for example "2 Mbit/s"'),
        (RATE, "12,5 Mbit/s", '"12,5 Mbit/s" is not a rate; write for example "2 Mbit/s"'),
        (RATE, "1__0 Mbit/s", '"1__0 Mbit/s" is not a rate; write for example "2 Mbit/s"'),
        (RATE, "1_ Mbit/s", '"1_ Mbit/s" is not a rate; write for example "2 Mbit/s"'),
        (RATE, "fast", '"fast" is not a rate; write for example "2 Mbit/s"'),
        (RATE, "2 mbit/s", 'unknown unit "mbit/s" (did you mean "Mbit/s"?)'),
        (RATE, "2 Mbps", 'unknown unit "Mbps" (did you mean "Mbit/s"?)'),
        (RATE, "2 Mb/s", 'unknown unit "Mb/s" (did you mean "Mbit/s"?)'),
        (RATE, "-2 B/s", 'must be a finite rate above 0, not "-2 B/s"'),
        (RATE, "1e999 B/s", 'must be a finite rate above 0, not "1e999 B/s"'),
        (RATE, True, 'must be a rate such as "2 Mbit/s", not true'),
        (RATE, [1], 'must be a rate such as "2 Mbit/s", not an array'),
        (DURATION, "0.5 sec", 'unknown unit "sec" (did you mean "s"?)'),
        (DURATION, "1 day", 'unknown unit "day" (known units: "s", "ms", "us", "μs", "min", "h")'),
        (FRACTION, 40, "must be a fraction of at most 1, not 40"),
        (FRACTION, "101 %", 'must be a fraction of at most 1, not "101 %"'),
        (FRACTION, "40 percent", 'unknown unit "percent" (did you mean "%"?)'),
        (FRACTION, 0.0, "must be a finite fraction above 0, not 0.0"),
        (JOULE, 0.5, 'needs a unit; write for example "0.5 J"'),
        (JOULE, "2 joules", 'unknown unit "joules" (did you mean "J"?)'),
        (DURATION, 0, "must be a finite duration above 0, not 0"),
        (AGE, "-1 s", 'must be a finite duration of at least 0, not "-1 s"'),
        (AGE, math.nan, "must be a finite duration of at least 0, not nan"),
        (DURATION, math.nan, "must be a finite duration above 0, not nan"),
        (DURATION, 10**400, "must be a finite duration above 0, not a huge number"),
        (DURATION, "1e300 s", 'must be a duration of at most 1e+15 s, not "1e300 s"'),
        (AGE, "1e-10 s", 'must be a duration of at least 1e-09 s, not "1e-10 s"'),
        (RATE, "1e300 Mbit/s", 'must be a rate of at most 1e+15 B/s, not "1e300 Mbit/s"'),
        (JOULE, "1e-320 J", 'must be a quantity of energy of at least 1e-12 J, not "1e-320 J"'),
        (FRACTION, 1e-13, "must be a fraction of at least 1e-12, not 1e-13"),
    ],
)
def test_a_quantity_without_meaning_is_refused_with_what_to_write(dimension, written, message):
    """No unit, a wrong one, no number: each has its message."""
    with pytest.raises(QuantityError) as caught:
        dimension.parse(written)
    assert str(caught.value) == message


def test_models_take_quantities_and_describe_what_is_written():
    """The field types convert, and their schema is that of the written form."""

    class Model(BaseModel):
        rate: Rate
        size: Size
        window: Duration = 0.5
        part: Fraction = 0.1
        cost: Joule = 1e-6

    assert Model.model_validate({"rate": "8 kbit/s", "size": "1 kB"}).rate == 1000.0
    assert Model.model_json_schema()["properties"]["rate"]["type"] == "string"


@given(st.text(max_size=30) | st.integers() | st.floats() | st.none() | st.dates())
def test_anything_is_either_a_positive_quantity_or_refused(written):
    """No input gives zero, infinity or another exception."""
    for dimension in (RATE, SIZE, DURATION, FRACTION, JOULE):
        try:
            quantity = dimension.parse(written)
        except QuantityError:
            continue
        assert 0.0 < quantity < math.inf
