"""Numbers in attachments."""

import json
import struct

import msgpack
import pytest
from pydantic import ValidationError

from utility_specs.features.attachment import AttachmentTable
from utility_specs.features.sample import Sample


def feature(**said):
    return AttachmentTable(kind="attachment", **said).feature()


@pytest.mark.parametrize(("format", "packed"), [("json", lambda d: json.dumps(d).encode()), ("msgpack", msgpack.packb)])
def test_a_document_in_the_attachment(format, packed):  # noqa: A002 - as specs call it
    """The payload is another matter."""
    sample = Sample("k", b"5", packed({"priority": [2, 4]}))
    assert feature(format=format, path="priority[1]").measure(sample) == 4.0
    assert feature(format=format, path="priority", reduce="mean").measure(sample) == 3.0


@pytest.mark.parametrize(
    ("name", "code", "value"),
    [("int8", "b", -3), ("uint8", "B", 200), ("int16", "h", -300), ("uint16", "H", 60000), ("int32", "i", -70000),
     ("uint32", "I", 2**32 - 1), ("int64", "q", -(2**40)), ("uint64", "Q", 2**50), ("float32", "f", 0.5),
     ("float64", "d", 0.1)],
)  # fmt: skip
@pytest.mark.parametrize(("order", "sign"), [("little", "<"), ("big", ">")])
def test_a_number_among_the_bytes(name, code, value, order, sign):
    """At its offset, in either byte order."""
    raw = b"\xaa\xbb\xcc" + struct.pack(sign + code, value)
    assert feature(format=name, offset=3, byte_order=order).measure(Sample("k", b"", raw)) == value


@pytest.mark.parametrize("attachment", [None, b"", b"\x01\x02\x03"])
def test_no_attachment_or_one_that_is_too_short(attachment):
    """The caller then takes the default."""
    with pytest.raises((ValueError, struct.error)):
        feature(format="float32").measure(Sample("k", b"\0" * 8, attachment))


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ({"format": "float32", "path": "a"}, 'path has no meaning with format = "float32"'),
        ({"format": "json", "offset": 4}, 'offset has no meaning with format = "json"'),
        ({"format": "json", "offset": -1}, "greater than or equal"),
        ({"format": "int8", "offset": 2**31}, "less than or equal"),
        ({"format": "float16"}, "Input should be"),
        ({}, "Field required"),
    ],
)
def test_what_has_no_meaning_is_refused(said, message):
    """When the spec is loaded."""
    with pytest.raises(ValidationError, match=message):
        AttachmentTable(kind="attachment", **said)
