"""What all put on the air is told by cumulative counts, which may come late or not at all."""

import pytest

from planner import Throughput
from planner.airtime import Airtime
from proxy.core.congestion.evidence import Load
from proxy.core.model.limits import Limit

BYTES = Limit("bytes", 0.5, 50_000.0, Throughput(100_000.0))
AIR = Limit("air", 0.5, 0.5, Airtime(1.0, 125_000.0))


def test_the_part_of_a_limit_that_all_use_together():
    """Robots' rates add up, each by its own clock; counts that are no news change nothing."""
    load = Load()
    for t in range(5):
        load.note(t, "a", 1000.0 + t, 10 * t, 20_000 * t)
        load.note(t, "b", t, 5 * t, 5_000 * t)
    load.note(4.5, "b", 2.0, 999, 999_999)
    assert load.parts(4.5, [BYTES])[0] == pytest.approx(0.25)
    (air,) = load.parts(4.5, [AIR])
    assert air == pytest.approx(10 * AIR.measure.use(2000, 1, own=False) + 5 * AIR.measure.use(1000, 1, own=False))


def test_who_is_not_heard_or_has_left_uses_nothing():
    """Nothing is known of them."""
    load = Load()
    for t in range(3):
        load.note(t, "a", t, t, 10_000 * t)
        load.note(t, "b", t, t, 10_000 * t)
    load.forget("b")
    assert load.parts(2.0, [BYTES])[0] == pytest.approx(0.1)
    assert load.parts(9.0, [BYTES]) == (0.0,)


def test_one_count_is_no_rate():
    """Nor is one that restarted."""
    load = Load()
    load.note(0.0, "a", 0.0, 10, 100_000)
    assert load.parts(0.0, [BYTES]) == (0.0,)
    load.note(1.0, "a", 1.0, 0, 0)
    assert load.parts(1.0, [BYTES]) == (0.0,)
