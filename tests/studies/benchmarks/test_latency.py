"""The grids with latency."""

from studies.benchmarks.latency import LATENCIES, WORKLOADS, measure_latency


def test_every_workload_has_a_table_for_each_latency():
    """They are told apart by their titles."""
    titles = [table.title for table in measure_latency(quick=True)]
    assert len(set(titles)) == len(LATENCIES) * len(WORKLOADS)
    assert titles[2].endswith("the paper's workload, latency 1 s")
