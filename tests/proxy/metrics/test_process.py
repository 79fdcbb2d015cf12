"""What is told of the process, beside what Prometheus' own library tells."""

import os
import time

from prometheus_client import CollectorRegistry, ProcessCollector, generate_latest
from prometheus_client.parser import text_string_to_metric_families

from proxy import clock
from proxy.metrics.process import ProcessMetrics


def families(text):
    """Return the metrics by name: kind, words, value."""
    found = text_string_to_metric_families(text)
    return {each.name: (each.type, each.documentation, each.samples[0].value) for each in found}


def test_the_same_is_told_as_by_the_library_of_prometheus():
    """Names, kinds and words; values as far as they do not change."""
    registry = CollectorRegistry()
    ProcessCollector(registry=registry)
    theirs, ours = families(generate_latest(registry).decode()), families(ProcessMetrics().text())
    assert {name: each[:2] for name, each in ours.items()} == {name: each[:2] for name, each in theirs.items()}
    assert ours["process_max_fds"] == theirs["process_max_fds"]
    assert abs(ours["process_start_time_seconds"][2] - theirs["process_start_time_seconds"][2]) < 2.0
    assert 0.5 < ours["process_resident_memory_bytes"][2] / theirs["process_resident_memory_bytes"][2] < 2.0


def test_files_that_are_open_are_counted():
    """Each by one, and not the one that counts."""
    metrics = ProcessMetrics()
    before = families(metrics.text())["process_open_fds"][2]
    more = os.open("/dev/null", os.O_RDONLY)
    try:
        assert families(metrics.text())["process_open_fds"][2] == before + 1
    finally:
        os.close(more)


def test_processor_time_is_that_of_now():
    """It only grows."""
    metrics = ProcessMetrics()
    first, until = families(metrics.text())["process_cpu_seconds"][2], time.process_time() + 0.01
    while time.process_time() < until:
        pass
    assert families(metrics.text())["process_cpu_seconds"][2] >= first + 0.01


def test_the_start_is_by_the_wall_clock_as_it_is_now(monkeypatch):
    """A robot that boots without a clock did not start in 1970; what is not set does not change."""
    right, ahead = clock.wall, [-1e9]
    monkeypatch.setattr(clock, "wall", lambda: right() + ahead[0])
    metrics, told = ProcessMetrics(), []
    for ahead[0] in (-1e9, 0.0, 0.1, 0.0):
        told.append(families(metrics.text())["process_start_time_seconds"][2])
    assert abs(told[1] - told[0] - 1e9) < 1.0
    assert told[1] == told[2] == told[3]
