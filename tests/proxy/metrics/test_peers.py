"""What metrics tell of other robots."""

from tests.proxy.metrics.statuses import PEER, scraped, status


def test_what_is_not_known_of_a_robot_is_not_told():
    """A way that nobody has measured has no latency, rather than one of 0 s."""
    found = scraped(status(peers=[PEER]))
    assert found["peers",] == 1
    assert {name: value for name, value in found.items() if name[0].startswith("peer_")} == {
        ("peer_takes_part", "r2"): 1,
        ("peer_latency_seconds", "in", "r2"): 0.002,
        ("peer_latency_seconds_per_byte", "in", "r2"): 1e-6,
        ("peer_loss_ratio", "out", "r2"): 0.25,
        ("peer_clock_ahead_seconds", "r2"): -0.5,
        ("peer_digest_age_seconds", "r2"): 0.1,
        ("peer_samples_received_total", "r2"): 12,
    }


def test_two_robots_of_one_name_are_no_fault():
    """Prometheus refuses a page on which a value stands twice."""
    found = scraped(status(peers=[PEER, PEER | {"samples": 13}]))
    assert found["peers",] == 2
    assert found["peer_samples_received_total", "r2"] == 13


def test_names_may_hold_anything():
    """Quotes and line ends of a type or robot do not break the page."""
    name = 'a "b"\n\\c'
    assert scraped(status(peers=[PEER | {"robot": name}]))["peer_takes_part", name] == 1


def test_what_daemons_tell_each_other_is_told():
    """Beside what they may, and what of it was not taken in."""
    found = scraped(status(digests={"allowance": 500.0, "told": 60, "heard": 70}, refused={"digest:old": 2}))
    assert found["digest_allowance_bytes_per_second",] == 500
    assert (found["digest_told_bytes_total",], found["digest_heard_bytes_total",]) == (60, 70)
    assert found["messages_refused_total", "digest:old"] == 2
