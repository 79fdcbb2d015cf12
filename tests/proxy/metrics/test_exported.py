"""The metrics: what they are called, and what of the status they tell."""

import re

import pytest

from proxy.metrics.exported import METRICS, UNITS
from tests.proxy.metrics.statuses import LIMIT, scraped, status


def test_names_and_labels_are_as_prometheus_wants_them():
    """Small letters, each name once, no unit but base units, and a sentence that says what it is."""
    names = [metric.exported for metric in METRICS]
    assert len(names) == len(set(names))
    for metric in METRICS:
        assert re.fullmatch(r"sendworthy_[a-z]+(_[a-z]+)*", metric.exported)
        assert not re.search(r"_(ms|millis|milliseconds|kb|kilobytes|percent|count|sum)(_|$)", metric.exported)
        assert metric.exported.endswith("_total") == (metric.kind == "counter")
        assert all(re.fullmatch("[a-z]+(_[a-z]+)*", label) for label in metric.labels)
        assert metric.help[0].isupper() or metric.help[0] == "1"
        assert metric.help.endswith((".", "]."))


def test_a_daemon_that_has_just_started_tells_what_it_is():
    """Which versions, which specs, which mode."""
    found = scraped(status())
    assert found["build_info", "1.2", str(status()["wire_version"])] == 1
    assert found["specs_info", status()["specs"]] == 1
    assert [found["mode", mode] for mode in ("pass", "shadow", "enforce")] == [0, 0, 1]
    assert found["uptime_seconds",] == 3.0
    assert found["reloads_total",] == 2
    assert found["reloads_refused_total",] == 1
    assert found["warnings",] == 0


def test_samples_are_told_by_reason():
    """What went and what was dropped are two metrics, so each can be added up."""
    counts = {
        "in": 9,
        "queued": 1,
        "by_reason": {"forwarded": 5, "passed:no-spec": 1, "dropped:planner": 2},
        "bytes": {"passed:no-spec": 70},
    }
    found = scraped(status(counts=counts))
    assert found["samples_received_total",] == 9
    assert found["samples_queued",] == 1
    assert {name: value for name, value in found.items() if name[0].startswith(("samples_forw", "samples_drop"))} == {
        ("samples_forwarded_total", "forwarded"): 5,
        ("samples_forwarded_total", "passed:no-spec"): 1,
        ("samples_dropped_total", "dropped:planner"): 2,
    }
    assert found["samples_passed_bytes_total", "passed:no-spec"] == 70


def test_decisions_are_told_by_information_type():
    """However many keys there are."""
    types = {"pose": {"streams": 50, "generated": 100, "by_reason": {"forwarded": 50, "superseded": 50}}}
    found = scraped(status(types=types))
    assert {name: value for name, value in found.items() if name[0].startswith("type_")} == {
        ("type_samples_generated_total", "pose"): 100,
        ("type_samples_decided_total", "forwarded", "pose"): 50,
        ("type_samples_decided_total", "superseded", "pose"): 50,
        ("type_streams", "pose"): 50,
    }


@pytest.mark.parametrize(("symbol", "unit"), UNITS.items())
def test_limits_are_told_in_their_units(symbol, unit):
    """A limit of energy is one of joules."""
    found = scraped(status(budget=[LIMIT | {"unit": symbol}]))
    assert {name: value for name, value in found.items() if name[0].startswith("channel_")} == {
        (f"channel_limit_{unit}", "throughput"): 1000,
        (f"channel_held_{unit}", "throughput"): 500,
        (f"channel_used_{unit}", "throughput"): 250,
        ("channel_used_ratio", "throughput"): 0.25,
        ("channel_price_per_byte", "throughput"): 0.00025,
        ("channel_window_seconds", "throughput"): 0.5,
    }


def test_a_limit_that_follows_the_channel_tells_what_is_in_force():
    """And how long the queue is, where one is known; a limit of nothing is no fault."""
    limit = LIMIT | {"limit": 0.0, "adaptive": {"in_force": 0.5, "delay": None}}
    found = scraped(status(budget=[limit]))
    assert found["channel_adaptive_ratio", "throughput"] == 0.5
    assert found["channel_used_ratio", "throughput"] == 0.0
    assert ("channel_queue_delay_seconds", "throughput") not in found


def test_queues_and_rules_are_told():
    """What waits, beside what may; what the rules kept."""
    found = scraped(status())
    assert found["queue_samples", "covered"] == 4
    assert found["queue_bytes", "passing"] == 500
    assert found["queue_limit_samples",] == 4096
    assert found["bridge_denied_total", "out", "samples"] == 6
    assert found["core_refused_items_total",] == 3
