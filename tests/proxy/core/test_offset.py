"""The clock offset from four timestamps."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.offset import ClockOffset


@given(st.floats(-1e6, 1e6), st.floats(0.001, 2.0), st.integers(1, 100))
def test_the_offset_is_found_through_varying_delays(offset, latency, seed):
    """The pairs that waited least give offset and latency, however long the others waited."""
    rng = np.random.default_rng(seed)
    clock = ClockOffset()
    for i in range(20):
        wait = 0.0 if i == 10 else rng.exponential(0.3)
        clock.heard(sent=i - offset, received=i + latency + wait)
        wait = 0.0 if i == 12 else rng.exponential(0.3)
        clock.echoed(sent=float(i), received=i - offset + latency + wait)
    assert clock.known
    assert clock.offset == pytest.approx(offset, abs=1e-6)
    assert clock.latency == pytest.approx(latency, abs=1e-6)
    assert clock.ours(5.0 - offset) == pytest.approx(5.0, abs=1e-6)


def test_before_the_first_echo_the_way_here_counts_as_no_time():
    """One direction alone gives an offset that is late by the latency, and no latency."""
    clock = ClockOffset()
    assert (clock.offset, clock.latency, clock.known) == (0.0, 0.0, False)
    clock.heard(sent=100.0, received=7.5)
    assert clock.offset == -92.5
    assert clock.latency == 0.0
