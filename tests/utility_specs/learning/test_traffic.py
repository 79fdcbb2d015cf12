"""All that was seen."""

import pytest

from proxy.core.forecast.schedule import Schedule
from tests.utility_specs.learning.team import regular
from utility_specs.learning import Observed, traffic
from utility_specs.learning.traffic import Traffic


def test_streams_are_keys_of_one_origin():
    """Two robots on one key are two streams."""
    samples = [Observed(0.0, "map", b"1", origin="a"), Observed(1.0, "map", b"22", origin="b")]
    seen = Traffic.of([*samples, Observed(2.0, "k", b"3", attachment=b"33")], Schedule)
    assert [stream.key for stream in seen.streams] == ["k", "map", "map"]
    assert (seen.count, seen.bytes, seen.duration) == (3, 6, 2.0)


def test_rates_are_those_of_windows():
    """Empty ones count, however many they are."""
    seen = Traffic.of(regular("k", 4.0, lambda _: b"x" * 50, 5.0), Schedule)
    assert (seen.rate(0.5), seen.rate(1.0)) == (200.0, 200.0)
    seen = Traffic.of([Observed(0.0, "k", b"x" * 100), Observed(1e11, "k", b"x" * 300)], Schedule)
    assert (seen.rate(0.5), seen.rate(1.0)) == (0.0, 600.0)


@pytest.mark.parametrize("key", ["", "a//b", "a/*", "a/{b}", "a/$*", "a\nb", "a/b#", "k" * 513, "/a"])
def test_keys_that_no_spec_can_name_are_counted(key):
    """They are not looked into."""
    seen = Traffic.of([Observed(0.0, key, b""), Observed(0.0, "k", b"")], Schedule)
    assert (seen.odd, seen.count) == (1, 1)


def test_there_is_room_for_so_many_streams(monkeypatch):
    """Samples of others are counted."""
    monkeypatch.setattr(traffic, "MOST_STREAMS", 2)
    seen = Traffic.of([Observed(float(i), f"k{i % 3}", b"") for i in range(6)], Schedule)
    assert (seen.count, seen.untold) == (4, 2)


def test_there_is_room_for_so_many_windows(monkeypatch):
    """Later ones are not told from empty ones."""
    monkeypatch.setattr(traffic, "MOST_WINDOWS", 2)
    assert Traffic.of([Observed(float(i), "k", b"x" * i) for i in range(6)], Schedule).rate(1.0) == 2.0
