"""The daemon's clocks."""

import math
from datetime import UTC, datetime

from proxy import clock
from proxy.tuning import TUNING


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
    assert abs(watch.look(now + 2.0).offset - clock.wall_offset()) < 0.1
    assert watch.look(now + 2.5) is None
    assert watch.look(now + 4.0) is None


def test_the_kernel_says_how_wrong_the_clock_may_be():
    """At most the 16 s up to which it counts, unless nobody ever told it."""
    error = clock.kernel_error()
    assert math.isinf(error) or 0.0 <= error <= 16.0


def errors(bound, *kernel):
    """What is told of the error of a clock, one look every two seconds; None where nothing is."""
    known = iter(kernel)
    watch = clock.WallWatch(clock.wall_offset(), bound, lambda: next(known))
    now = clock.monotonic()
    looks = [watch.look(now + 2.0 * (i + 1)) for i in range(len(kernel))]
    return [look and look.error for look in looks]


def test_an_error_that_nobody_vouches_for_is_not_told():
    """Whatever the kernel says; nor is one that is told while the kernel calls the clock wrong."""
    assert errors(0.0, 0.001, 0.001) == [None, None]
    assert errors(0.02, math.inf, math.inf) == [None, None]
    assert errors(0.02, 0.001, math.inf, 1.5) == [0.02, 0.0, None]
    assert errors(0.6, 0.1, 0.7, 0.1) == [0.6, 0.0, 0.6]


def test_it_grows_while_the_kernel_hears_nothing():
    """In steps of twice as much, each told once."""
    assert errors(0.02, 0.0, 0.019, 0.021, 0.04, 0.041, 0.9) == [0.02, None, 0.04, None, 0.08, 0.0]


def test_it_shrinks_when_it_has_been_less_for_long():
    """What comes and goes with each poll of chrony is no news each time."""
    looks = 2 + int(TUNING.wall_clock_calm / 2.0)
    told = errors(0.02, 0.06, 0.06, *[0.01] * looks)
    assert told[0] == 0.08
    assert [each for each in told[1:] if each is not None] == [0.02]
    assert told.index(0.02) >= looks - 1
