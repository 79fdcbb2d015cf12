"""Rates over some seconds."""

import pytest

from proxy.page.steady import Steady
from proxy.page.tuning import TUNING
from proxy.top.frames import Scene
from proxy.top.rates import Change
from tests.proxy.top.statuses import R1, later


def made(steady, status):
    change = steady.over(Scene({"z": Change(status)})).changes["z"]
    return {stream["made"] for stream in change.streams()}


def test_rates_are_of_the_last_seconds_however_often_it_is_looked():
    """What comes in jumps of 20 samples comes evenly; who looks again before there is news changes nothing."""
    steady, status = Steady(), R1
    assert made(steady, status) == {None}
    for step in range(40):
        status = later(status, seconds=0.5, made=20 if step % 4 == 0 else 0, sent=0)
        found = made(steady, status)
        assert made(steady, status) == found
    assert list(found) == pytest.approx([10.0], rel=2.0 / TUNING.count_window)
    assert len(steady._said["z"]) <= 2 * TUNING.count_window + 2


def test_a_daemon_that_started_anew_or_went_begins_anew():
    """Counts that fell are no rate."""
    steady = Steady()
    made(steady, later(R1))
    assert made(steady, R1) == {None}
    steady.over(Scene({}))
    assert made(steady, later(R1)) == {None}
