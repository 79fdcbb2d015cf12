"""The bridge benchmark measures what really goes through real processes."""

import pytest

from studies.benchmarks.bridge.arrangements import arranged
from studies.benchmarks.bridge.measure import flow, latency


@pytest.mark.parametrize("name", ["direct", "router", "pass"])
def test_what_is_published_comes_through_and_is_timed(name):
    """With a latency for each paced sample, and the cost of what is between; a busy daemon may have to drop some."""
    with arranged(name) as line:
        latencies = latency(line, 2_000, 0.3)
        assert len(latencies) > 10
        assert all(0.0 < each < 5.0 for each in latencies)
        through = flow(line, 64, 0.3)
    assert through.part == 1.0 if name != "pass" else 0.0 < through.part <= 1.0
    assert through.rate > 0.0
    assert (through.cost > 0.0) == (name != "direct")


def test_where_a_spec_decides_newer_samples_supersede():
    """Far more goes in than comes out."""
    with arranged("covered") as line:
        through = flow(line, 64, 0.5)
    assert 0.0 < through.part < 0.5
    assert through.sent > through.rate
