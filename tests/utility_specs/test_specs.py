"""Specs in use: matching keys, extracting features, computing scales."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
import zenoh
from hypothesis import given
from hypothesis import strategies as st

from planner.problem import Aggregation
from planner.utility import Custom, Video
from utility_specs import InformationType, Specs, load_specs
from utility_specs.expressions import Expression
from utility_specs.features import Feature, Sample, Size
from utility_specs.forecast import FeatureForecast
from utility_specs.key_formats import KeyFormat
from utility_specs.specs import LARGEST_SCALE, MATCHES_KEPT, UTILITIES_KEPT


@dataclass(frozen=True)
class KeyLength(Feature):
    """A feature that needs no payload."""

    reads_payload = False

    def measure(self, sample: Sample) -> float:
        return float(len(sample.key))


@dataclass(frozen=True)
class Odd(Feature):
    """A feature that always fails: it has no finite value, or raises."""

    value: float | None

    def measure(self, _sample: Sample) -> float:
        if self.value is None:
            raise RuntimeError("no value")
        return self.value


class Counted:
    """A payload that counts its copies."""

    def __init__(self, raw: bytes) -> None:
        self.raw, self.copies = raw, 0

    def to_bytes(self) -> bytes:
        self.copies += 1
        return self.raw


class Broken:
    def to_bytes(self) -> bytes:
        raise ValueError("gone")


def information_type(name="t", keys=("t/**",), weight=1.0, scale="1", **features) -> InformationType:
    return InformationType(
        name=name,
        formats=tuple(map(KeyFormat.parse, keys)),
        aggregation=Aggregation.MOST_RECENT,
        weighing=Expression.compile(str(weight), features),
        utility=Video(),
        expression=Expression.compile(scale, features),
        features=tuple(features.items()),
        forecast=FeatureForecast(),
    )


@pytest.mark.parametrize(
    ("key", "name"),
    [
        ("robot/r1/camera", "camera"),
        ("robot/r1/pose", "rest"),
        ("robot/r1/arm/camera", "rest"),
        ("front/camera", "camera"),
        ("robot", "rest"),
        ("map", None),
        ("robot/@adv/x", None),
        ("robot//camera", None),
        ("", None),
    ],
)
def test_a_key_belongs_to_the_first_type_that_includes_it(key, name):
    """Zenoh's own rules decide; a key that is none belongs to no type."""
    camera = information_type("camera", ("robot/*/camera", "front/camera"))
    specs = Specs((camera, information_type("rest", ("robot/**",))), (), "")
    for _ in range(2):
        found = specs.match(key)
        assert (found.name if found else None) == name


def test_the_memory_of_matches_is_bounded_and_counts_what_it_forgets():
    """Endless keys do not fill the memory."""
    specs = Specs((information_type(),), (), "")
    for number in range(MATCHES_KEPT + 5):
        assert specs.match(f"t/{number}") is specs.types[0]
    assert specs.matches_evicted == 5
    assert specs.match("t/0") is specs.types[0]


def test_empty_specs_cover_nothing():
    """Without specs every key passes."""
    assert Specs.empty().match("robot/r1/camera") is None
    assert Specs.empty() == Specs.empty()


def test_the_scale_is_weight_times_expression():
    """Features that are missing take their defaults, unknown ones are ignored."""
    each = information_type(weight=2.0, scale="1 + 10 * red", red=Size(default=0.3))
    assert each.scale({"red": 0.5, "blue": 9.0}) == 12.0
    assert each.scale({}) == 8.0
    assert each.failures.counts() == {}


@pytest.mark.parametrize("size", [1e20, 1e300])
def test_a_scale_has_an_upper_bound(size):
    """Robots do not tell each other of more; nor where the product has no value, and the weight stands for it."""
    each = information_type(weight=1e20, scale="size", size=Size())
    assert each.scale({"size": size}) == LARGEST_SCALE


def test_a_scale_below_zero_means_worth_nothing():
    """A negative value is not a failure."""
    each = information_type(scale="1 - size", size=Size())
    assert each.scale({"size": 9.0}) == 0.0
    assert each.failures.counts() == {}


@pytest.mark.parametrize("size", [0.0, math.nan, math.inf, 1e-308])
def test_a_scale_without_a_finite_value_is_the_weight_and_is_counted(size):
    """Division by zero, NaN and overflow never reach the planner."""
    each = information_type(weight=30.0, scale="1e308 * size if size > 1 else 1 / size", size=Size())
    assert each.scale({"size": size}) == 30.0
    assert each.failures.counts() == {"scale": 1}


@given(st.dictionaries(st.sampled_from(["size", "x"]), st.floats()))
def test_a_scale_is_always_finite_and_never_negative(features):
    """Whatever a peer claims its features to be."""
    scale = information_type(weight=3.0, scale="size ** 3 / (1 - size)", size=Size()).scale(features)
    assert 0.0 <= scale < math.inf


def test_every_sample_has_the_utility_of_its_type():
    """Features make no difference to a utility that knows none."""
    each = information_type(red=Size())
    assert each.utility_of({"red": 3.0}) is each.utility


def coloured(calls=None) -> InformationType:
    def by_red(age, features):
        if calls is not None:
            calls.append(dict(features))
        return features["red"] * np.exp(-age)

    return replace(information_type(red=Size(default=0.5)), utility=Custom(by_red, {"red": 0.5}))


def test_a_python_utility_is_tabulated_once_for_the_features_of_a_sample():
    """Features that are not given take their defaults, unknown ones are ignored."""
    calls = []
    each = coloured(calls)
    for _ in range(3):
        assert each.utility_of({"red": 2.0, "blue": 9.0}).value(np.zeros(1)) == 2.0
        assert each.utility_of({}).value(np.zeros(1)) == 0.5
    assert calls == [{"red": 0.5}, {"red": 2.0}, {"red": 0.5}]


def test_a_python_utility_that_fails_in_flight_is_that_of_the_defaults_and_is_counted():
    """Whatever the features of a sample are, the daemon flies on."""
    each = coloured()
    assert each.utility_of({"red": -1.0}) is each.utility
    assert each.utility_of({"red": 1.0}) is not each.utility
    assert each.failures.counts() == {"utility": 1}


def test_the_memory_of_tabulated_utilities_is_bounded():
    """Features that never repeat do not fill the memory."""
    calls = []
    each = coloured(calls)
    for red in range(UTILITIES_KEPT + 1):
        each.utility_of({"red": float(red)})
    each.utility_of({"red": 1.0})
    assert len(calls) == UTILITIES_KEPT + 2
    each.utility_of({"red": 0.0})
    assert len(calls) == UTILITIES_KEPT + 3


@pytest.mark.parametrize("payload", [b"abc", bytearray(b"abc"), memoryview(b"abc"), zenoh.ZBytes(b"abc")])
def test_features_are_extracted_from_any_kind_of_payload(payload):
    """Bytes, their views and Zenoh's own bytes are alike."""
    each = information_type(size=Size())
    assert each.needs_payload
    assert each.extract("t/1", payload) == {"size": 3.0}


def test_a_payload_is_copied_once_and_only_when_a_feature_reads_it():
    """Copies are made when needed."""
    payload = Counted(b"abc")
    assert information_type().extract("t", payload) == {}
    keyed = information_type(length=KeyLength())
    assert not keyed.needs_payload
    assert keyed.extract("t/1", payload) == {"length": 3.0}
    assert payload.copies == 0
    assert information_type(a=Size(), b=Size()).extract("t/1", payload) == {"a": 3.0, "b": 3.0}
    assert payload.copies == 1


@pytest.mark.parametrize("feature", [Odd(value, default=0.5) for value in (None, math.nan, math.inf)])
def test_a_feature_that_fails_takes_its_default_and_is_counted(feature):
    """The others are not affected."""
    each = information_type(odd=feature, size=Size())
    for _ in range(2):
        assert each.extract("t/1", b"abc") == {"odd": 0.5, "size": 3.0}
    assert each.failures.counts() == {"odd": 2}


def test_a_payload_that_cannot_be_copied_fails_the_features_that_read_it():
    """What does not need the payload still has its value."""
    each = information_type(size=Size(default=7.0), length=KeyLength())
    assert each.extract("t", Broken()) == {"size": 7.0, "length": 1.0}
    assert each.failures.counts() == {"size": 1}


CAPTURING = """\
[[information_type]]
name = "camera"
keys = ["robot/${robot:*}/camera/${n:*}", "**/${robot:*}/spare/${n:*}"]
utility = { kind = "python", function = "tests.utility_specs.worths:by_number" }
weight = "2 if robot == 'r1' else 1"
scale = "10 - n"
features.size = { kind = "size" }
"""


def test_captured_chunks_are_known_to_weight_scale_and_utility(tmp_path):
    """Each key has a type that knows its chunks; keys with the same ones share it."""
    (tmp_path / "spec.toml").write_text(CAPTURING)
    specs = load_specs(tmp_path)
    first, other = specs.match("robot/r1/camera/3"), specs.match("robot/r2/camera/4")
    assert (first.weight, specs.types[0].weight) == (2.0, 1.0)
    assert first.scale({}) == 14.0
    assert other.scale({}) == 6.0
    assert first.utility_of({}).features == {"size": 0.0, "n": 3.0}
    assert first.extract("robot/r1/camera/3", b"12") == {"size": 2.0}
    assert first is specs.match("robot/r1/camera/3")
    assert specs.match("a/b/r1/spare/3") is specs.match("c/r1/spare/3")
    assert first.failures is other.failures


def test_a_chunk_that_is_no_number_is_counted_as_a_failure(tmp_path):
    """Then the scale is 1."""
    (tmp_path / "spec.toml").write_text(CAPTURING)
    front = load_specs(tmp_path).match("robot/r1/camera/front")
    assert front.scale({}) == 2.0
    assert front.failures.counts() == {"scale": 1}
    assert front.utility_of({}) is front.utility
    assert front.failures.counts() == {"scale": 1, "utility": 1}


def test_a_weight_without_a_value_counts_as_1():
    """And is counted by its own name."""
    each = information_type(weight="1 / size", size=Size(default=0.0))
    assert each.scale({"size": 4.0}) == 0.25
    assert each.scale({}) == 1.0
    assert each.failures.counts() == {"weight": 1}


def test_a_product_beyond_all_numbers_is_the_weight():
    """Weight and scale may each have a value, and both together none."""
    each = information_type(weight=10.0, scale="size", size=Size(default=1e308))
    assert each.scale({}) == 10.0
    assert each.failures.counts() == {"scale": 1}
