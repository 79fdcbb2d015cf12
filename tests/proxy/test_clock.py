"""The daemon's clocks."""

from datetime import UTC, datetime

from proxy import clock


def test_the_wall_clock_is_seconds_since_1970():
    """It agrees with the calendar to a second."""
    assert abs(clock.wall() - datetime.now(UTC).timestamp()) < 1.0


def test_the_monotonic_clock_never_goes_back():
    """Two readings are in order."""
    assert clock.monotonic() <= clock.monotonic()
