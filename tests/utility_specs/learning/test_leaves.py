"""The numbers and words in documents."""

import msgpack
import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tests.utility_specs.features.test_cdr import SCAN, STORE, scan
from utility_specs.features.document import MsgpackTable
from utility_specs.features.sample import Sample
from utility_specs.learning.leaves import DEEPEST, MOST, Leaf, leaves

NAMES = st.text(max_size=6) | st.integers(-2, 5) | st.sampled_from(["a.b", 'q"', "[0]", "charge"])
DOCUMENTS = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**63), 2**64 - 1)
    | st.floats()
    | st.text(max_size=8)
    | st.binary(max_size=4),
    lambda inner: st.lists(inner, max_size=6) | st.dictionaries(NAMES, inner, max_size=4),
    max_leaves=12,
)


@given(DOCUMENTS)
def test_a_feature_finds_what_a_leaf_shows(document):
    """Under the path of the leaf, and with what it makes of an array; whatever the document is."""
    payload = msgpack.packb(document)
    for leaf, value in leaves(msgpack.unpackb(payload, strict_map_key=False)).items():
        said = {} if leaf.reduce is None else {"reduce": leaf.reduce}
        if isinstance(value, str):
            said["equals"] = value
        feature = MsgpackTable(kind="msgpack", path=leaf.path, **said).feature()
        assert feature.measure(Sample("k", payload)) == (1.0 if isinstance(value, str) else value)


def test_places_have_paths():
    """Names, indices of short arrays, what is between brackets."""
    document = {"pose": {"p": [1, 2.5]}, "a.b": 3, "ok": True, "state": "low", 7: 1, "none": None}
    assert leaves(document) == {
        Leaf("pose.p", "length"): 2.0,
        Leaf("pose.p[0]"): 1.0,
        Leaf("pose.p[1]"): 2.5,
        Leaf('["a.b"]'): 3.0,
        Leaf("ok"): 1.0,
        Leaf("state"): "low",
        Leaf("[7]"): 1.0,
    }
    assert leaves(3.5) == {Leaf(""): 3.5}


def test_long_arrays_are_reduced():
    """To their ends, or the greatest of each number in their elements; bytes to their length."""
    assert leaves({"r": [5, 1, 2, 3, 4]}) == {Leaf("r", "length"): 5, Leaf("r", "min"): 1, Leaf("r", "max"): 5}
    assert leaves({"d": [{"score": 0.5}, {"score": 0.75, "class": "x"}]}) == {
        Leaf("d", "length"): 2,
        Leaf("d[*].score", "max"): 0.75,
    }
    assert leaves({"d": []}) == {Leaf("d", "length"): 0}
    assert leaves({"big": [10**400]}) == {Leaf("big", "length"): 1}
    assert leaves({"data": np.zeros(9, np.uint8)}) == {Leaf("data", "length"): 9}


def test_messages_of_ros_are_documents():
    """Field by field, infinite ranges left out."""
    found = leaves(STORE.deserialize_cdr(scan(), SCAN))
    assert (found[Leaf("header.stamp.sec")], found[Leaf("header.frame_id")]) == (12.0, "base_link")
    assert found[Leaf("ranges[1]")] == 2.5
    assert Leaf("ranges[0]") not in found
    assert not any("__" in leaf.path for leaf in found)


def test_what_nobody_measures_is_left_out():
    """Long or unprintable words, huge numbers, names that no path can have, what is too deep or too much."""
    assert leaves({"a": "x" * 41, "b": "\n", "c": 10**30, 'd"': 1, "e\n": 1, "f" * 41: 1, -1: 1, True: 1, "": ""}) == {}
    deep = 1
    for _ in range(DEEPEST + 1):
        deep = {"d": deep}
    assert leaves(deep) == {}
    assert len(leaves({str(i) + "n": i for i in range(100)})) == MOST
