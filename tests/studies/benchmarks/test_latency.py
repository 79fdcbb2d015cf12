"""The grids with latency."""

from studies.benchmarks.latency import LATENCIES, WORKLOADS


def test_every_workload_has_a_table_for_each_latency(measured):
    """They are told apart by their titles."""
    chart, *tables = measured("latency")
    assert all(len(series.values) == len(LATENCIES) for series in chart.series)
    titles = [table.title for table in tables]
    assert len(set(titles)) == len(LATENCIES) * len(WORKLOADS)
    assert titles[2].endswith("the paper's workload, latency 1 s")
