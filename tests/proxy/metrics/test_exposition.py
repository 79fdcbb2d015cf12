"""What Prometheus reads, and how often the status is read."""

import math

import pytest
from prometheus_client.parser import text_string_to_metric_families

from proxy import clock
from proxy.metrics import exposition as served
from proxy.metrics.exported import METRICS
from proxy.metrics.exposition import FRESH, Exposition
from tests.proxy.metrics.statuses import status


def samples(text):
    """Return the values of our own metrics, as the library of Prometheus reads them, by name and labels."""
    families = text_string_to_metric_families(text.decode())
    found = [each for family in families for each in family.samples if each.name.startswith("sendworthy_")]
    return {(each.name, *sorted(each.labels.items())): each.value for each in found}


def test_many_who_ask_at_once_get_one_reading(monkeypatch):
    """The core is disturbed a few times a second at most."""
    now, read = 100.0, []
    monkeypatch.setattr(clock, "monotonic", lambda: now)
    exposition = Exposition(lambda: read.append(now) or status())
    assert exposition.text() is exposition.text()
    now += FRESH
    exposition.text()
    assert read == [100.0, 100.0 + FRESH]


def test_a_daemon_that_was_too_busy_is_asked_again():
    """An error is not kept."""
    answers = iter([TimeoutError, None])

    def read():
        if error := next(answers):
            raise error
        return status()

    exposition = Exposition(read)
    with pytest.raises(TimeoutError):
        exposition.text()
    assert exposition.text()


@pytest.mark.parametrize("value", [0.0, 3, 0.1, 1e300, 5e-324, 123456789012.0, math.inf, -math.inf])
def test_values_are_told_to_the_last_bit(value):
    """Those that are not finite, too."""
    found = samples(Exposition(lambda: status() | {"uptime": value}).text())
    assert found["sendworthy_uptime_seconds", ("robot", "r1")] == value


@pytest.mark.parametrize("name", ['a"b', "a\\nb", "a\nb", "\u00e4{},="])
def test_labels_are_told_as_they_are(name):
    """Whatever a name may hold."""
    found = samples(Exposition(lambda: status() | {"specs": name}).text())
    assert found["sendworthy_specs_info", ("generation", name), ("robot", "r1")] == 1.0


def test_names_that_were_met_are_not_all_remembered(monkeypatch):
    """What comes and goes takes no memory, and is told all the same."""
    names = iter(f"r{number}" for number in range(100))
    monkeypatch.setattr(served, "FRESH", 0.0)
    monkeypatch.setattr(served, "NAMES", 40)
    monkeypatch.setattr(served, "METRICS", [metric for metric in METRICS if metric.name in ("uptime_seconds", "mode")])
    exposition = Exposition(lambda: status(robot=next(names)))
    for number in range(100):
        assert samples(exposition.text())["sendworthy_uptime_seconds", ("robot", f"r{number}")] == 3.0
    assert len(exposition._names) <= 40
