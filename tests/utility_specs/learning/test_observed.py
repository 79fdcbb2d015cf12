"""A sample as an observer sees it."""

from utility_specs.learning import Observed


def test_only_time_key_and_payload_are_needed():
    """The rest is what a recording may lack."""
    sample = Observed(1.0, "a", b"x")
    assert (sample.encoding, sample.attachment, sample.origin) == ("", None, None)
