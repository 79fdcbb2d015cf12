"""The bridge benchmark measures what really goes through real processes."""

from proxy.bridge.tuning import TUNING
from studies.benchmarks.bridge.arrangements import PIECE, QUICK


def test_what_is_published_comes_through_and_is_timed(measured):
    """Latencies of all but those whose samples may be dropped, and the cost of what is between."""
    latencies, flows, memory = measured("bridge")
    assert [row[0] for row in latencies.rows] == [f"{size} B, {name}" for size in SIZES for name in QUICK[:-1]]
    for row in latencies.rows:
        p50, p99 = map(float, row[1:3])
        assert 0.0 < p50 <= p99
    assert [row[0] for row in flows.rows] == [f"{size} B, {name}" for size in SIZES for name in QUICK]
    for name, sent, rate, _, arrived, cost in flows.rows:
        assert float(sent.replace(",", "")) > 0.0
        # Too few of what is large, or is superseded, may come to be timed.
        assert float(rate.replace(",", "")) > 0.0 or name.startswith("40") or "covered" in name
        assert 0 < int(arrived.rstrip("%")) <= 100 or "covered" in name
        assert (cost == "-") == ("direct" in name)
    assert [row[0] for row in memory.rows] == list(QUICK[1:])
    assert all(float(row[1]) > 0.0 for row in memory.rows)


def test_where_a_spec_decides_newer_samples_supersede(measured):
    """More goes in than comes out."""
    (row,) = [row for row in measured("bridge")[1].rows if row[0] == "64 B, covered"]
    assert int(row[4].rstrip("%")) < 100


def test_a_router_beside_a_daemon_sends_in_pieces_of_the_same_size():
    """So that it tells what these cost."""
    assert int(PIECE) == TUNING.batch


SIZES = ("64", "40,000")
