"""What needs attention."""

from proxy.status.warnings import RECENT, warnings


def test_a_daemon_that_is_well_has_no_warnings():
    """Nor has one of another version that says nothing."""
    assert warnings({}) == []


def test_what_the_daemon_says_comes_first():
    """Then what its counts show, the daemon's own faults before others'."""
    status = {"warnings": ["a"], "malformed": 1, "daemon": {"faults": 2}, "kept": {"conserved": False}}
    found = warnings(status)
    assert [each[:8] for each in found] == ["a", "the coun", "internal", "1 malfor"]


def test_messages_of_another_version_are_over_when_none_comes_any_more():
    """As when all robots have been upgraded; a daemon that does not say when the last one came had one just now."""
    said = ["4 messages of another version of Sendworthy were not understood"]
    for age, found in ((None, said), (RECENT / 2, said), (2 * RECENT, [])):
        assert warnings({"other_version": 4, "other_version_age": age}) == found
