"""What real daemons do with real traffic: robots and an operator on one machine, and all that crosses between them."""

from studies.benchmarks.traffic.measure import measure_traffic

__all__ = ["measure_traffic"]
