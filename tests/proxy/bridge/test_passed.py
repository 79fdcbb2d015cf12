"""Counts of what the core never sees one by one."""

from concurrent.futures import ThreadPoolExecutor

from proxy.bridge.passed import Passed
from proxy.core.interface.events import SamplesPassed


def test_counts_are_handed_over_by_reason_and_start_again():
    """Each sample is in exactly one report."""
    passed = Passed()
    passed.add("a", 10)
    passed.add("b", 0)
    passed.add("a", 5)
    assert passed.take(1.0) == [SamplesPassed(1.0, "a", 2, 15), SamplesPassed(1.0, "b", 1, 0)]
    assert passed.take(2.0) == []


def test_nothing_is_lost_between_threads():
    """Several threads count while another takes: the sum is right."""
    passed = Passed()
    reports = []

    def count(_):
        for _ in range(2000):
            passed.add("a", 1)

    with ThreadPoolExecutor() as pool:
        done = pool.map(count, range(4))
        for _ in range(50):
            reports += passed.take(0.0)
        list(done)
    reports += passed.take(0.0)
    assert sum(report.count for report in reports) == sum(report.size for report in reports) == 8000
