"""The clock offset from four timestamps."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.transit.offset import ClockOffset
from proxy.core.transit.tuning import TUNING

DELAYS = st.floats(0.0, 3.0)


@given(
    offset=st.floats(-1e5, 1e5),
    drifts=st.lists(st.floats(-TUNING.drift, TUNING.drift), min_size=1, max_size=8),
    messages=st.lists(st.tuples(st.floats(0.001, 20.0), st.booleans(), DELAYS, DELAYS), min_size=2, max_size=25),
)
def test_the_error_is_never_more_than_the_uncertainty(offset, drifts, messages):
    """Whatever waits in either direction, whichever digests are echoed, however the clocks drift and turn."""
    clock = ClockOffset()
    turns = np.cumsum([0.0, *(gap for gap, *_ in messages), 10.0])
    rates = np.resize(drifts, len(turns))
    ahead = np.concatenate([[0.0], np.cumsum(np.diff(turns) * rates[:-1])])

    def theirs(ours):
        """Their clock when ours shows `ours`."""
        return ours - offset - float(np.interp(ours, turns, ahead))

    sent_ours, echo = 0.0, None
    for (_, echoed, out, back), at in zip(messages, turns[1:], strict=False):
        received = at + back
        clock.heard(theirs(at), received)
        if echoed and echo is not None and echo[1] <= theirs(at):
            clock.echoed(*echo)
        for now in (received, received + 7.0):
            error = abs(clock.offset - (now - theirs(now)))
            assert error <= clock.uncertainty(now) + 1e-9
        assert clock._range == clock._narrowed(*clock._by_digests())
        sent_ours, echo = at, (at, theirs(at + out))
    assert clock.jumps == 0
    assert sent_ours <= turns[-1]


@given(st.floats(-1e6, 1e6), st.floats(0.001, 2.0), st.integers(1, 100))
def test_the_offset_is_found_through_varying_delays(offset, latency, seed):
    """The messages that waited least give offset and latency, to what clocks may drift between them."""
    rng = np.random.default_rng(seed)
    clock = ClockOffset()
    for i in range(20):
        wait = 0.0 if i == 10 else rng.exponential(0.3)
        clock.heard(sent=i - offset, received=i + latency + wait)
        wait = 0.0 if i == 12 else rng.exponential(0.3)
        clock.echoed(sent=float(i), received=i - offset + latency + wait)
    assert clock.known
    assert clock.offset == pytest.approx(offset, abs=TUNING.drift * 5.0)
    assert clock.latency == pytest.approx(latency, abs=TUNING.drift * 10.0)
    assert clock.ours(5.0 - offset) == pytest.approx(5.0, abs=TUNING.drift * 5.0)


def test_before_the_first_echo_the_way_here_counts_as_no_time():
    """One direction alone gives an offset that is late by the latency, which nothing bounds, and no latency."""
    clock = ClockOffset()
    assert (clock.offset, clock.latency, clock.known, clock.uncertainty(0.0)) == (0.0, 0.0, False, math.inf)
    clock.heard(sent=100.0, received=7.5)
    assert clock.offset == -92.5
    assert clock.latency == 0.0
    assert clock.uncertainty(7.5) == math.inf


def test_what_is_presumed_of_the_way_holds_until_an_echo_tells():
    """The offset and the latency go by it, but nobody knows."""
    clock = ClockOffset()
    clock.presume(0.1)
    assert clock.latency == 0.1
    clock.heard(sent=100.0, received=7.5)
    assert (clock.offset, clock.latency, clock.known) == (pytest.approx(-92.6), 0.1, False)
    assert clock.uncertainty(7.5) == math.inf
    clock.echoed(sent=8.0, received=100.9)
    assert (clock.offset, clock.latency, clock.known) == (pytest.approx(-92.7, abs=0.001), pytest.approx(0.2), True)


def test_uncertainty_is_half_the_best_round_trip_and_grows_as_clocks_drift():
    """Until a better round trip comes."""
    clock = ClockOffset()
    clock.heard(10.0, 10.02)
    clock.echoed(10.0, 10.04)
    assert clock.uncertainty(10.02) == pytest.approx(0.03, abs=1e-4)
    assert clock.uncertainty(110.02) == pytest.approx(0.03 + 100.0 * TUNING.drift, abs=1e-4)
    clock.heard(110.0, 110.02)
    clock.echoed(110.0, 110.04)
    assert clock.uncertainty(110.02) == pytest.approx(0.03, abs=1e-4)
    clock.echoed(110.1, 110.11)
    assert clock.uncertainty(110.12) == pytest.approx(0.015, abs=1e-4)


@pytest.mark.parametrize("slept", [60.0, -60.0])
def test_a_clock_that_stood_still_is_found_out(slept):
    """A robot that slept: the next round trip counts, what was before does not. The other way round, we slept."""
    clock = ClockOffset()
    for i in range(5):
        clock.heard(float(i), i + 0.02)
        clock.echoed(float(i), i + 0.02)
    for i in (200.0, 201.0):
        clock.heard(i - slept, i + 0.02)
        clock.echoed(i, i - slept + 0.02)
    assert clock.jumps == 1
    assert clock.offset == pytest.approx(slept, abs=1e-3)
    assert clock.uncertainty(201.0) < 0.03


@given(
    offset=st.floats(-1e5, 1e5),
    wrong=st.floats(-0.02, 0.02),
    ways=st.tuples(DELAYS, DELAYS),
    later=st.floats(0.0, 50.0),
    drift=st.floats(-TUNING.drift, TUNING.drift),
)
def test_wall_clocks_that_are_right_bound_it_too(offset, wrong, ways, later, drift):
    """However unlike the ways there and back are; the truth is never outside."""
    clock = ClockOffset()
    clock.heard(100.0 - offset, 100.0 + ways[0])
    clock.echoed(100.0, 100.0 - offset + ways[1])
    before = clock.uncertainty(101.0)
    clock.shown(100.0, offset + wrong, 0.02)
    assert clock.uncertainty(101.0) <= min(before, 0.021) + 1e-3
    at = 104.0 + later
    theirs = at - offset - drift * (at - 100.0)
    clock.heard(theirs, at)
    assert abs(clock.offset - (at - theirs)) <= clock.uncertainty(at) + 1e-6
    assert clock.jumps == 0


def far(*shown):
    """Ways there and back that take a second each, an offset of 5 s, and what wall clocks show."""
    clock = ClockOffset()
    clock.heard(0.0, 6.0)
    clock.echoed(6.0, 2.0)
    if shown:
        clock.shown(6.0, *shown)
    return clock


def test_wall_clocks_that_cannot_be_right_count_for_nothing():
    """Digests prove it, and clocks have not jumped."""
    for wrong in (far(6.2, 0.1), far(3.8, 0.1)):
        assert (wrong.offset, wrong.uncertainty(6.0)) == (far().offset, far().uncertainty(6.0))
        assert wrong.jumps == 0
    assert far(5.7, 0.1).offset == pytest.approx(5.7, abs=1e-3)
    assert far(5.7, 0.1).latency == pytest.approx(1.0, abs=1e-3)


def test_what_wall_clocks_show_alone_is_not_enough():
    """How wrong the clock of a robot may be is known when there was an echo."""
    clock = ClockOffset()
    clock.heard(0.0, 6.0)
    clock.shown(6.0, 5.0, 0.1)
    assert clock.uncertainty(6.0) == math.inf
    assert clock.offset == pytest.approx(5.0)


def test_a_clock_that_was_set_was_wrong():
    """What it showed before is forgotten."""
    clock = far(5.0, 0.02)
    assert clock.uncertainty(6.0) == pytest.approx(0.02, abs=1e-4)
    clock.unshown()
    assert clock.uncertainty(6.0) == pytest.approx(1.0, abs=1e-2)
