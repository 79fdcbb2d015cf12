"""What all features have in common."""

import math
from dataclasses import replace
from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from tests.utility_specs.features import scenes
from tests.utility_specs.features.test_cdr import BATTERY, battery
from utility_specs import SpecsError, load_specs
from utility_specs.features import AnyFeatureTable, ColorFraction, Size

ANY = TypeAdapter(AnyFeatureTable)

EVERY = {
    "attachment": {"format": "msgpack", "path": "a"},
    "raw_attachment": {"kind": "attachment", "format": "float64"},
    "brightness": {},
    "cdr": {"type": BATTERY, "field": "percentage"},
    "cells": {"kind": "cdr", "type": BATTERY, "field": "cell_voltage", "reduce": "max"},
    "change": {"format": "sensor_msgs/msg/CompressedImage"},
    "color_fraction": {"color": "red"},
    "image": {"kind": "brightness", "format": "sensor_msgs/msg/Image"},
    "json": {"path": "a[*].b", "reduce": "mean"},
    "key_chunk": {"index": -1},
    "msgpack": {"path": "a.b[0]"},
    "python": {"function": f"{__name__}:first"},
    "raw": {"kind": "brightness", "format": "raw", "width": 2, "height": 2, "encoding": "mono8"},
    "sharpness": {},
    "size": {},
}


def first(_key: str, payload: bytes) -> float:
    return payload[0] / (payload[0] - 1)


@pytest.fixture(scope="module")
def covering(tmp_path_factory):
    """An information type with features of every kind."""
    path = tmp_path_factory.mktemp("specs") / "x.toml"
    path.write_text('[[information_type]]\nname = "t"\nkeys = ["t/**"]\nutility = { kind = "video" }\n')
    tables = {name: ANY.validate_python({"kind": name, "default": -7.0} | said) for name, said in EVERY.items()}
    (loaded,) = load_specs(path).types
    return replace(loaded, features=tuple((name, table.feature()) for name, table in tables.items()))


PIXEL = scenes.checked(0, 255)[:4, :4]
REAL = [
    battery(),
    scenes.encoded(PIXEL),
    scenes.encoded(PIXEL, ".jpg"),
    scenes.encoded(PIXEL, ".webp"),
    scenes.ros_image(PIXEL),
    scenes.ros_compressed(scenes.encoded(PIXEL)),
    b'{"a": [{"b": 1}, {"b": NaN}]}',
    b"\x81\xa1a\x81\xa1b\x91\x01",
    b"[" * 5000,
    b"\x91" * 5000,
]


@st.composite
def payloads(draw):
    """Real payloads with bytes changed and cut off, and any bytes."""
    raw = bytearray(draw(st.sampled_from(REAL) | st.binary(max_size=60)))
    for _ in range(draw(st.integers(0, 4)) if raw else 0):
        raw[draw(st.integers(0, len(raw) - 1))] = draw(st.integers(0, 255))
    return bytes(raw[: draw(st.integers(0, len(raw)) | st.just(len(raw)))])


def test_no_kind_is_forgotten():
    """Those below are tried with every kind that there is."""
    union = get_args(get_args(AnyFeatureTable)[0])
    kinds = {get_args(table.model_fields["kind"].annotation)[0] for table in union}
    assert {said.get("kind", name) for name, said in EVERY.items()} == kinds


@given(st.text("t/0-1²x", max_size=8), payloads(), st.none() | payloads())
def test_whatever_comes_every_feature_has_a_finite_value(covering, key, payload, attachment):
    """What cannot be computed has its default and is counted; nothing is raised."""
    before = sum(covering.failures.counts().values())
    values = covering.extract(key, payload, attachment)
    assert set(values) == set(EVERY)
    assert all(math.isfinite(value) for value in values.values())
    defaults = sum(value == -7.0 for value in values.values())
    assert before <= sum(covering.failures.counts().values()) <= before + defaults


def test_each_kind_makes_its_feature():
    """The kind in the table decides, default and budget are taken over."""
    assert ANY.validate_python({"kind": "size", "default": 2.0}).feature() == Size(default=2.0)
    red = ANY.validate_python({"kind": "color_fraction", "color": "red", "budget": "5 ms"})
    assert red.feature() == ColorFraction("red", budget=0.005)
    for name, said in EVERY.items():
        feature = ANY.validate_python({"kind": name, "default": 3.0, "budget": 2} | said).feature()
        assert (feature.default, feature.budget) == (3.0, 2.0)


def test_every_key_is_described():
    """Editors show it."""
    tables = [
        definition for definition in ANY.json_schema()["$defs"].values() if "kind" in definition.get("properties", {})
    ]
    assert len(tables) == len({said.get("kind", name) for name, said in EVERY.items()})
    for table in tables:
        assert table["description"]
        for key, said in table["properties"].items():
            assert key == "kind" or said["description"]


@pytest.mark.parametrize(
    "table",
    [
        {},
        {"kind": "sise"},
        {"kind": "size", "default": float("inf")},
        {"kind": "size", "budget": 0},
        {"kind": "size", "budget": "5 m"},
    ],
)
def test_a_table_without_meaning_is_refused(table):
    """No kind, an unknown one, an infinite default, no time at all, metres."""
    with pytest.raises(ValidationError):
        ANY.validate_python(table)


MISTAKES = [
    ('{ kind = "jsn" }', 'x.kind: unknown kind "jsn" (did you mean "json"?)'),
    ('{ kind = "json", pth = "a" }', 'x.pth: unknown key (did you mean "path"?)'),
    ('{ kind = "json", path = "a..b" }', 'x.path: "a..b" is not a path; write for example '),
    ('{ kind = "json", path = "a[*]" }', "x: with [*] there are many values: add reduce = "),
    ('{ kind = "json", path = "a", reduce = "avg" }', 'x.reduce: unknown "avg" (known: "length", '),
    ('{ kind = "json", path = "a", equals = [1] }', "x.equals: must be a string, a number, true or"),
    ('{ kind = "size", budget = "5 m" }', 'x.budget: unknown unit "m" (did you mean "min"?)'),
    ('{ kind = "cdr", type = "sensor_msgs/msg/BatteryState", field = "volts" }', "x.field: "),
    (
        '{ kind = "cdr", type = "a/msg/B", field = "c" }',
        'x.type: unknown type "a/msg/B"; add a',
    ),
    ('{ kind = "brightness", format = "raw" }', 'x: format = "raw" needs width, height and encoding'),
    ('{ kind = "brightness", format = "jpg" }', 'x.format: unknown "jpg" (known: "compressed", "raw", '),
    ('{ kind = "sharpness", downscale = 3 }', "x.downscale: must be 1, 2, 4 or 8, not 3"),
    ('{ kind = "key_chunk" }', "x.index: is missing"),
    ('{ kind = "python", function = "nowhere:f" }', 'x.function: cannot import "nowhere"'),
    ('{ kind = "attachment", format = "f32" }', 'x.format: unknown "f32" ('),
]


def test_mistakes_are_named_by_file_line_and_key(tmp_path):
    """When the spec is loaded, all of them."""
    path = tmp_path / "x.toml"
    features = "".join(f"features.x{number} = {feature}\n" for number, (feature, _) in enumerate(MISTAKES))
    path.write_text('[[information_type]]\nname = "t"\nkeys = ["t"]\nutility = { kind = "video" }\n' + features)
    with pytest.raises(SpecsError) as caught:
        load_specs(path)
    assert len(caught.value.problems) == len(MISTAKES)
    for number, ((_, message), problem) in enumerate(zip(MISTAKES, caught.value.problems, strict=True)):
        place = f'{path}:{5 + number}: information_type "t": features.x{number}'
        assert str(problem).startswith(place + message.removeprefix("x"))
