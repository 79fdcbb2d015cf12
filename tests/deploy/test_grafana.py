"""The dashboard for Grafana asks for what daemons export, and shows of each topic what matters."""

import itertools
import json
import re

import pytest

from proxy.metrics.exported import ABOUT, CHANNEL, DECISIONS, METRICS, QUEUES, SAMPLES
from proxy.metrics.peers import PEERS
from tests.daemons import ROOT

DASHBOARD = json.loads((ROOT / "deploy" / "grafana" / "sendworthy.json").read_text())
PANELS = [panel for panel in DASHBOARD["panels"] if panel["type"] != "row"]
TARGETS = [(panel["title"], target) for panel in PANELS for target in panel["targets"]]
LABELS = {metric.exported: {"robot", "instance", *metric.labels} for metric in METRICS}
EVERYWHERE = '{robot=~"$robot", instance=~"$instance"'
IMPORTANT = {
    "about": (ABOUT, {"build_info", "specs_info", "mode", "uptime_seconds", "warnings", "faults", "reloads_refused"}),
    "samples": (
        SAMPLES,
        {
            *("samples_received", "samples_forwarded", "samples_dropped", "samples_delivered", "samples_queued"),
            *("type_samples_generated", "type_samples_decided", "kept_copies_waiting"),
        },
    ),
    "channel": (
        CHANNEL,
        {
            *("channel_used_ratio", "channel_used_bytes", "channel_held_bytes", "channel_limit_bytes"),
            *("channel_price_per_byte", "channel_scarce_drops", "channel_adaptive_ratio", "sent_bytes"),
        },
    ),
    "decisions": (
        DECISIONS,
        {
            *("decisions", "decision_seconds", "decision_longest_seconds", "decision_shortcuts", "decisions_proven"),
            *("decision_gap", "decision_utility"),
        },
    ),
    "queues": (
        QUEUES,
        {
            *("queue_samples", "queue_bytes", "queue_limit_samples", "queue_limit_bytes", "core_waiting_items"),
            *("core_refused_items", "bridge_denied"),
        },
    ),
    "robots": (
        PEERS,
        {
            *(
                "peers",
                "peer_latency_seconds",
                "peer_loss_ratio",
                "peer_clock_ahead_seconds",
                "peer_digest_age_seconds",
            ),
            *("digest_told_bytes", "digest_heard_bytes", "digest_allowance_bytes_per_second", "messages_refused"),
        },
    ),
}


def named(query):
    """Return the metrics that a query names."""
    return re.findall(r"\bsendworthy_\w+", query)


def test_grafana_takes_it():
    """It has an identity, a version of the format, and panels with a place, a source and queries."""
    assert DASHBOARD["uid"] == "sendworthy"
    assert DASHBOARD["title"] == "Sendworthy"
    assert DASHBOARD["schemaVersion"] >= 36  # sources are objects since then
    assert "id" not in DASHBOARD, "that is the installation's to give"
    identities = [panel["id"] for panel in DASHBOARD["panels"]]
    assert len(set(identities)) == len(identities)
    for panel in PANELS:
        assert panel["title"]
        assert panel["description"]
        assert panel["datasource"] == {"type": "prometheus", "uid": "${datasource}"}
        assert [target["refId"] for target in panel["targets"]] == list("ABCD"[: len(panel["targets"])])
        assert all(target["expr"] for target in panel["targets"])


def test_no_panel_lies_on_another():
    """Each field of the grid belongs to one panel at most."""
    taken = set()
    for panel in DASHBOARD["panels"]:
        place = panel["gridPos"]
        assert place["x"] + place["w"] <= 24
        across, down = range(place["x"], place["x"] + place["w"]), range(place["y"], place["y"] + place["h"])
        fields = set(itertools.product(across, down))
        assert not fields & taken, panel["title"]
        taken |= fields


def test_the_source_and_the_robots_are_chosen():
    """From what Prometheus has; at first all."""
    variables = {variable["name"]: variable for variable in DASHBOARD["templating"]["list"]}
    assert list(variables) == ["datasource", "robot", "instance"]
    assert (variables["datasource"]["type"], variables["datasource"]["query"]) == ("datasource", "prometheus")
    for name in ("robot", "instance"):
        assert variables[name]["includeAll"]
        query = variables[name]["query"]["query"]
        assert query.startswith("label_values(sendworthy_build_info")
        assert query.endswith(f", {name})")


@pytest.mark.parametrize(("title", "target"), TARGETS, ids=lambda part: part if isinstance(part, str) else "")
def test_queries_ask_for_what_is_exported(title, target):
    """For metrics by name, of the chosen robots, by labels that they have; of counters, for how fast they grow."""
    query = target["expr"]
    assert named(query), title
    for metric in named(query):
        assert metric in LABELS
        assert f"{metric}{EVERYWHERE}" in query
        assert metric.endswith("_total") == bool(re.search(rf"(rate|increase)\({metric}\b", query))
    known = set.intersection(*(LABELS[metric] for metric in named(query)))
    grouped = re.findall(r"by \(([^)]*)\)", query)
    selected = re.findall(r'(\w+)(?:=~|!~|=)"', query)
    shown = re.findall(r"{{(\w+)}}", target["legendFormat"])
    assert {*selected, *", ".join(grouped).split(", ")} - {""} <= known
    assert set(shown) <= (set(grouped[0].split(", ")) if grouped else known)


@pytest.mark.parametrize("topic", IMPORTANT)
def test_what_matters_of_each_topic_is_shown(topic):
    """Somebody who looks at the dashboard sees at least this."""
    metrics, important = IMPORTANT[topic]
    exported = {metric.name: metric.exported for metric in metrics}
    asked = {metric for _title, target in TARGETS for metric in named(target["expr"])}
    assert {name for name in important if exported[name] not in asked} == set()


def test_a_state_is_that_of_now():
    """A mode that was left, or specs that were replaced, are not shown beside those in force."""
    for panel in PANELS:
        if panel["type"] == "stat":
            assert all(target["instant"] for target in panel["targets"]), panel["title"]
