"""How often the status is read."""

import pytest

from proxy import clock
from proxy.metrics.collector import FRESH, StatusCollector
from tests.proxy.metrics.statuses import status


def test_many_who_ask_at_once_get_one_reading(monkeypatch):
    """The core is disturbed a few times a second at most."""
    now, read = 100.0, []
    monkeypatch.setattr(clock, "monotonic", lambda: now)
    collector = StatusCollector(lambda: read.append(now) or status())
    assert collector.collect() is collector.collect()
    now += FRESH
    collector.collect()
    assert read == [100.0, 100.0 + FRESH]


def test_a_daemon_that_was_too_busy_is_asked_again():
    """An error is not kept."""
    answers = iter([TimeoutError, None])

    def read():
        if error := next(answers):
            raise error
        return status()

    collector = StatusCollector(read)
    with pytest.raises(TimeoutError):
        collector.collect()
    assert collector.collect()
