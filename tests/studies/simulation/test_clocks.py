"""Clocks of simulated robots."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from studies.simulation.clocks import EPOCH, Clock, booted_without_time, synchronised


@given(st.floats(-1e6, 1e6), st.floats(-500, 500), st.floats(0, 1e5))
def test_the_true_time_can_be_read_from_a_monotonic_clock(offset, drift, t):
    """Whatever its offset and drift."""
    clock = Clock(offset, drift)
    assert clock.true(clock.monotonic(t)) == pytest.approx(t, abs=1e-6)


def test_a_clock_that_drifts_gains_so_many_parts_per_million():
    """100 ppm are 6 ms a minute."""
    clock = Clock(drift=100.0)
    assert clock.monotonic(60.0) - clock.monotonic(0.0) == pytest.approx(60.006)


def test_a_wall_clock_steps_and_the_monotonic_one_does_not():
    """Each step counts from its time on."""
    clock = Clock(wall=5.0, steps=((10.0, 60.0), (20.0, -60.0)))
    assert [clock.wall_time(t) - EPOCH - t for t in (0.0, 10.0, 20.0)] == [5.0, 65.0, 5.0]
    assert clock.monotonic(20.0) == Clock().monotonic(20.0)


def test_a_robot_without_time_starts_in_1970():
    """Until it is set right."""
    clock = booted_without_time(30.0)
    assert clock.wall_time(1.0) == 1.0
    assert clock.wall_time(30.0) == EPOCH + 30.0


def test_synchronised_clocks_are_wrong_by_no_more_than_they_say():
    """Each by something else."""
    clocks = synchronised(("r1", "r2", "op"), 0.02, 7)
    off = [clock.wall_time(3.0) - EPOCH - 3.0 for clock in clocks.values()]
    assert len(set(off)) == 3
    assert max(map(abs, off)) <= 0.02 + 1e-6
    assert {clock.error for clock in clocks.values()} == {0.02}
