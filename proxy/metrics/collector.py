"""Reads the metrics off the totals of the status whenever Prometheus asks: between two scrapes nothing is done."""

import math
import threading
from collections.abc import Callable

from prometheus_client import CollectorRegistry, ProcessCollector
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.core import Metric as Family
from prometheus_client.registry import Collector

from proxy import clock
from proxy.metrics.exported import METRICS
from proxy.metrics.metric import PREFIX, Metric, Status

FRESH = 0.2
"""The status is read this often at most [s], however many ask: it is read between two decisions."""
FAMILIES = {"counter": CounterMetricFamily, "gauge": GaugeMetricFamily}


class StatusCollector(Collector):
    """Collects from what `read` returns, which may raise TimeoutError. From any thread."""

    def __init__(self, read: Callable[[], Status]) -> None:
        self._read = read
        self._lock = threading.Lock()
        self._read_at = -math.inf
        self._families: list[Family] = []

    def collect(self) -> list[Family]:
        """Return every metric that has a value."""
        with self._lock:
            if clock.monotonic() >= self._read_at + FRESH:
                self._families = self._collect()
                self._read_at = clock.monotonic()
            return self._families

    def _collect(self) -> list[Family]:
        status = self._read()
        families = (_family(metric, status) for metric in METRICS)
        return [family for family in families if family.samples]


def registry_of(read: Callable[[], Status]) -> CollectorRegistry:
    """Return a registry of all metrics of a daemon, those of its process among them."""
    registry = CollectorRegistry()
    ProcessCollector(registry=registry)
    registry.register(StatusCollector(read))
    return registry


def _family(metric: Metric, status: Status) -> Family:
    """Return a metric with its values. Where two robots have one name the one that was met last is meant."""
    family: CounterMetricFamily | GaugeMetricFamily = FAMILIES[metric.kind](
        PREFIX + metric.name, metric.help, labels=("robot", *metric.labels)
    )
    robot = str(status["robot"])
    for labels, value in dict(metric.rows(status)).items():
        family.add_metric((robot, *labels), value)
    return family
