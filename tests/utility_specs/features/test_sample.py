"""What features share of a sample."""

import pytest

from utility_specs.errors import FeatureError
from utility_specs.features.sample import Sample


class Counted:
    def __init__(self, raw):
        self.raw, self.copies = raw, 0

    def to_bytes(self):
        self.copies += 1
        return self.raw


def test_payload_and_attachment_are_copied_once_and_when_they_are_read():
    """Not before, and not again."""
    payload, attachment = Counted(b"p"), Counted(b"a")
    sample = Sample("k", payload, attachment)
    assert (payload.copies, attachment.copies) == (0, 0)
    assert [sample.payload, sample.payload, sample.attachment, sample.attachment] == [b"p", b"p", b"a", b"a"]
    assert (payload.copies, attachment.copies) == (1, 1)


def test_a_sample_without_attachment_says_so():
    """Features of it have no value then."""
    with pytest.raises(FeatureError, match="k: the sample has no attachment"):
        _ = Sample("k", b"").attachment


def test_what_several_features_need_is_made_once():
    """By what it is; other things are made, too."""
    sample, made = Sample("k", b""), []
    for what in ("json", "json", "image"):
        assert sample.once(what, lambda what=what: made.append(what) or what) == what
    assert made == ["json", "image"]


def test_what_cannot_be_made_is_tried_once():
    """Everybody who asks is told why, and nothing of the first attempt is kept alive."""
    sample, tried = Sample("k", b""), []

    def fail():
        tried.append(1)
        raise RecursionError("too deep")

    for _ in range(2):
        with pytest.raises(FeatureError, match="k: RecursionError: too deep") as caught:
            sample.once("json", fail)
        assert caught.value.__context__ is None
    assert len(tried) == 1
