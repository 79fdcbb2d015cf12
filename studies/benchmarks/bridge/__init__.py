"""What the bridge costs: latency, throughput and memory, beside a stock Zenoh router."""

from studies.benchmarks.bridge.measure import measure_bridge

__all__ = ["measure_bridge"]
