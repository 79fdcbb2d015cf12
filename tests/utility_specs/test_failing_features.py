"""Why features fail, in words."""

import json

import cv2
import msgpack
import numpy as np
import pytest

from utility_specs.failing_features import LONGEST, reason_of
from utility_specs.features import Sample
from utility_specs.features.attachment import RawNumber
from utility_specs.features.brightness import Brightness
from utility_specs.features.document import Document
from utility_specs.features.key_chunk import KeyChunk
from utility_specs.features.path import steps_of
from utility_specs.features.python_function import PythonFunction
from utility_specs.features.reading import Reading


def reason(feature, payload=b"", attachment=None, key="robot/r1/state"):
    sample = Sample(key, payload, attachment)
    with pytest.raises(Exception) as raised:  # noqa: PT011 - whatever it raises is put into words
        feature.measure(sample)
    return reason_of(raised.value, feature, sample)


def field(path, form="json", **options):
    return Document(form, Reading(steps_of(path)), **options)


STATE = json.dumps({"battery": {"charge": "low"}, "cells": [1, 2]}).encode()

WORDS = {
    "charge": 'no field "charge" in the document (it has: "battery", "cells")',
    "batery.charge": 'no field "batery" in the document (did you mean "battery"?)',
    "battery.chrge": 'no field "chrge" in "battery" (did you mean "charge"?)',
    "cells[2]": 'no element 2 in "cells": it has 2',
    "battery.charge": "a str is not a number",
    "cells.first": "a list has no first",
    "battery[0]": 'no field "0" in "battery" (it has: "charge")',
    "cells[0].x": "a int has no x",
    "cells[-3]": 'no element -3 in "cells": it has 2',
}


@pytest.mark.parametrize("path", WORDS)
def test_what_a_document_lacks_is_named(path):
    """With what it has instead, so that a path can be put right."""
    assert reason(field(path), STATE) == WORDS[path]


@pytest.mark.parametrize(
    ("form", "payload", "words"),
    [
        ("json", b"\xff\xd8", "the payload is no JSON: 'utf-8' codec can't decode byte 0xff"),
        ("json", b"{", "the payload is no JSON: Expecting property name"),
        ("msgpack", b"\xc1", "the payload is no MessagePack"),
    ],
)
def test_what_is_no_document_is_said_to_be_none(form, payload, words):
    """With the decoder's own words."""
    assert reason(field("a", form), payload).startswith(words)


def test_a_sample_without_what_is_read_says_so():
    """Neither payload nor attachment is a broken one."""
    assert reason(field("a")) == "the sample has no payload"
    assert reason(Brightness()) == "the sample has no payload"
    assert reason(field("a", attached=True)) == "the sample has no attachment"
    assert reason(RawNumber("<f", 0)) == "the sample has no attachment"
    assert reason(field("a", attached=True), attachment=b"x").startswith("the attachment is no JSON: Expecting value")
    assert reason(field("[*]", "msgpack"), msgpack.packb([None])) == "a list is not a number"


def test_other_features_speak_for_themselves():
    """Their errors are told on one line, without the key, and not at length."""
    assert reason(Brightness(), b"no image") == "the payload is not an image"
    assert reason(KeyChunk(1), key="robot/r1a2") == "r1a2 has 2 numbers in it"
    assert reason(KeyChunk(7)) == "IndexError: list index out of range"

    def failing(_key, payload):
        raise ValueError(payload.decode())

    assert reason(PythonFunction(failing), b"one\ntwo") == "ValueError: one two"
    assert len(reason(PythonFunction(failing), b"x" * 1000)) == LONGEST
    assert reason(PythonFunction(lambda *_: next(iter(()))), b"x") == "StopIteration"


def test_an_image_is_no_failure():
    """The features of these tests fail for what they are given."""
    image = cv2.imencode(".png", np.zeros((8, 8, 3), np.uint8))[1].tobytes()
    assert Brightness().measure(Sample("a", image)) == 0.0
