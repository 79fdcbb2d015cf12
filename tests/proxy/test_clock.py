"""The daemon's clocks."""

from datetime import UTC, datetime

from proxy import clock


def test_the_wall_clock_is_seconds_since_1970():
    """It agrees with the calendar to a second."""
    before = datetime.now(UTC).timestamp()
    assert before - 1.0 < clock.wall() < datetime.now(UTC).timestamp() + 1.0


def test_the_monotonic_clock_never_goes_back():
    """Two readings are in order."""
    assert clock.monotonic() <= clock.monotonic()


def test_the_wall_offset_is_what_one_clock_shows_more_than_the_other():
    """Who reads one after the other finds more or less, as he reads this or that one first."""
    offset = clock.wall_offset()
    assert clock.wall() - clock.monotonic() < offset + 0.1
    assert clock.monotonic() - clock.wall() < -offset + 0.1


def test_a_wall_clock_that_nobody_sets_is_no_news():
    """However often one looks."""
    watch = clock.WallWatch(clock.wall_offset())
    now = clock.monotonic()
    assert [watch.look(now + 2.0 * i) for i in range(5)] == [None] * 5


def test_a_step_of_the_wall_clock_is_news_once():
    """At the next look, which comes no sooner than a second after the last."""
    watch = clock.WallWatch(clock.wall_offset() - 60.0)
    now = clock.monotonic()
    assert watch.look(now) is None
    assert abs(watch.look(now + 2.0) - clock.wall_offset()) < 0.1
    assert watch.look(now + 2.5) is None
    assert watch.look(now + 4.0) is None
