"""Counting what a recording does not have."""

from proxy.core.interface import events as ev
from proxy.recording.entries import Gap
from proxy.recording.missing import Missing
from tests.proxy.recording.lives import published


def test_events_are_counted_by_their_class():
    """With the number of the first one."""
    missing = Missing("full")
    assert not missing
    missing.event(7, published(1))
    missing.event(8, ev.SampleHanded(1.0, 1))
    missing.event(9, published(2))
    assert missing
    assert missing.gap(99) == Gap(7, 3, 2, 0, "full", {"SamplePublished": 2, "SampleHanded": 1})


def test_what_comes_next_is_added():
    """The first number and the reason stay, where there are any."""
    missing, next_one = Missing(), Missing("full")
    next_one.event(5, published(1))
    next_one.payload()
    missing.follow(next_one)
    missing.follow(next_one)
    assert missing.gap(0) == Gap(5, 2, 2, 2, "full", {"SamplePublished": 2})


def test_payloads_may_be_missing_alone():
    """Then no event is, and the next one is the one that is due."""
    missing = Missing("full")
    missing.payload()
    assert missing
    assert missing.gap(4) == Gap(4, 0, 0, 1, "full", {})


def test_a_long_time_takes_no_memory():
    """However many are missing."""
    missing = Missing()
    for number in range(10_000):
        missing.event(number, published(number))
    assert missing.events == 10_000
