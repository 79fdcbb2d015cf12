"""Statuses as daemons give them, without a daemon."""

from copy import deepcopy

from prometheus_client.parser import text_string_to_metric_families

from proxy.core.core import Core
from proxy.core.model.settings import CoreSettings
from proxy.metrics.exposition import Exposition
from utility_specs import Specs

DAEMON = {
    "reloads": {"done": 2, "refused": 1, "problems": []},
    "faults": 0,
    "delivered": 7,
    "waiting": 1,
    "refused": 3,
    "queue": {
        "covered": {"samples": 4, "bytes": 400},
        "passing": {"samples": 5, "bytes": 500},
        "most": {"samples": 4096, "bytes": 1 << 25},
    },
    "denied": {"out": {"samples": 6}, "in": {"samples": 0}},
}
"""What the parts around the core say, as far as metrics tell it."""
PEER = {
    "robot": "r2",
    "takes_part": True,
    "latency_in": {"fixed": 0.002, "per_byte": 1e-6},
    "latency_out": None,
    "loss_in": None,
    "loss_out": 0.25,
    "wall_ahead": -0.5,
    "digest_age": 0.1,
    "samples": 12,
}
LIMIT = {
    "constraint": "throughput",
    "unit": "B",
    "window": 0.5,
    "limit": 1000.0,
    "held": 500.0,
    "used": 250.0,
    "price_per_kb": 0.25,
}


def status(**changed):
    """Return what a daemon says that has just started, with some of it `changed`."""
    core = Core(CoreSettings("r1", "z-r1", version="1.2"), Specs.empty(), 0.0)
    return deepcopy(core.totals(3.0) | {"daemon": DAEMON} | changed)


def scraped(of):
    """Return every value of our metrics by name and labels, in the order of their names, `robot` left out."""
    text = Exposition(lambda: of).text().decode()
    samples = [sample for family in text_string_to_metric_families(text) for sample in family.samples]
    ours = [sample for sample in samples if sample.name.startswith("sendworthy_")]
    assert all(sample.labels.pop("robot") == of["robot"] for sample in ours)
    found = {
        (sample.name.removeprefix("sendworthy_"), *dict(sorted(sample.labels.items())).values()): sample.value
        for sample in ours
    }
    assert len(found) == len(ours)
    return found
