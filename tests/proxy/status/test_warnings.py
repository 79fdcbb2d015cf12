"""What needs attention."""

from proxy.status.warnings import warnings


def test_a_daemon_that_is_well_has_no_warnings():
    """Nor has one of another version that says nothing."""
    assert warnings({}) == []


def test_what_the_daemon_says_comes_first():
    """Then what its counts show, the daemon's own faults before others'."""
    status = {"warnings": ["a"], "malformed": 1, "daemon": {"faults": 2}, "kept": {"conserved": False}}
    found = warnings(status)
    assert [each[:8] for each in found] == ["a", "the coun", "internal", "1 malfor"]
