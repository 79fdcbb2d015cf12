"""Numbers in JSON and MessagePack."""

import json

import msgpack
import pytest

from utility_specs.features.document import JsonTable, MsgpackTable
from utility_specs.features.sample import Sample

POSE = {
    "pose": {"position": [{"x": 1.5, "y": -2}]},
    "state": "charging",
    "ok": True,
    "detections": [{"class": "person", "score": 0.25}, {"class": "dog", "score": 0.75}, {"class": "person"}],
    "names": {"a.b": 4},
}
CASES = [
    ({"path": "pose.position[0].x"}, 1.5),
    ({"path": "pose.position[-1].y"}, -2.0),
    ({"path": "ok"}, 1.0),
    ({"path": "state", "equals": "charging"}, 1.0),
    ({"path": "detections", "reduce": "length"}, 3.0),
    ({"path": "detections[*].score", "reduce": "max"}, 0.75),
    ({"path": "detections[*].class", "equals": "person", "reduce": "sum"}, 2.0),
    ({"path": 'names["a.b"]'}, 4.0),
]
KINDS = {"json": (JsonTable, lambda value: json.dumps(value).encode()), "msgpack": (MsgpackTable, msgpack.packb)}


@pytest.mark.parametrize(("said", "value"), CASES)
@pytest.mark.parametrize("kind", KINDS)
def test_a_value_is_read(kind, said, value):
    """As the path, the comparison and the reduction say."""
    table, packed = KINDS[kind]
    assert table(kind=kind, **said).feature().measure(Sample("k", packed(POSE))) == value


@pytest.mark.parametrize("kind", KINDS)
def test_a_payload_may_be_the_number_itself(kind):
    """Without a path."""
    table, packed = KINDS[kind]
    assert table(kind=kind).feature().measure(Sample("k", packed(23.5))) == 23.5


def test_maps_with_numbers_as_keys():
    """As MessagePack has them."""
    feature = MsgpackTable(kind="msgpack", path="[7].x").feature()
    assert feature.measure(Sample("k", msgpack.packb({7: {"x": 2}}))) == 2.0


@pytest.mark.parametrize("payload", [b"", b"{", b"[" * 100_000, b"\xff", b'{"x": "1"}', b"{}", b"1" * 5000])
def test_broken_json_has_no_value(payload):
    """Cut off, nested too deeply, not text, another type, missing, too long."""
    feature = JsonTable(kind="json", path="x" if payload.startswith(b"{") else "").feature()
    with pytest.raises((ValueError, LookupError)):
        feature.measure(Sample("k", payload))


@pytest.mark.parametrize("payload", [b"", b"\x81", b"\x91" * 100_000, b"\xc1", b"\xdd\xff\xff\xff\xff", b"\xa1x"])
def test_broken_msgpack_has_no_value(payload):
    """Cut off, nested too deeply, never used, larger than it is, another type."""
    with pytest.raises(ValueError, match=r"^k: |not a number"):
        MsgpackTable(kind="msgpack").feature().measure(Sample("k", payload))


def test_several_features_decode_a_payload_once():
    """The decoded document belongs to the sample."""
    sample = Sample("k", b'{"a": 1, "b": [2]}')
    documents = []
    for path in ("a", "b[0]"):
        JsonTable(kind="json", path=path).feature().measure(sample)
        documents.append(sample.once(("json", False), dict))
    assert documents[0] is documents[1]
    assert documents[0] == {"a": 1, "b": [2]}
