"""Numbers as they travel."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.protocol.fixed import coded, decoded, feature, rounded, seconds, single, ticks


@given(st.floats(2.0**-31, 2.0**31))
def test_a_value_is_sixteen_bits_and_nearly_exact(value):
    """To 0.05 %; and what was rounded once stays."""
    assert isinstance(coded(value), int)
    assert 0 <= coded(value) < 65_536
    assert rounded(value) == pytest.approx(value, rel=1 / 2048)
    assert rounded(rounded(value)) == rounded(value)


@given(st.integers(0, 2048))
def test_whole_numbers_are_exact(number):
    """Small ones travel in one byte."""
    assert rounded(float(number)) == number
    assert coded(number) == number or number >= 128


@given(st.floats(0.0, 1e300))
def test_what_does_not_fit_travels_in_single_precision(value):
    """Up to its range."""
    assert rounded(value) == pytest.approx(min(value, 3.4028234663852886e38), rel=1 / 2048, abs=1e-37)


@given(st.floats(0.0, 1e30), st.floats(0.0, 1e30))
def test_rounding_keeps_the_order(one, other):
    """The greater value is never the smaller one on the way."""
    assert (rounded(one) <= rounded(other)) or one > other


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_features_are_whole_or_single(value):
    """Identities stay what they are."""
    assert feature(12_345_678.0) == 12_345_678.0
    assert feature(value) in (value, single(value))
    assert feature(feature(value)) == feature(value)


def test_times_are_ticks():
    """A tenth of a millisecond."""
    assert (ticks(1.23456), seconds(12346)) == (12346, 1.2346)
    assert decoded(5) == 5.0
