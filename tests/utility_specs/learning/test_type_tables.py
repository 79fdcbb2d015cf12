"""The tables of types."""

import tomllib

import pytest

from tests.utility_specs.learning.team import PICTURES, json_bytes, regular, streams_of
from utility_specs.learning.patterns import kinds_of
from utility_specs.learning.type_tables import MOST_FEATURES, MOST_NAMES, UNREAD, type_table
from utility_specs.learning.writing import named


def table(*all_samples, duration=20.0):
    """The lines of the one type of all samples."""
    (learned,) = named(kinds_of(streams_of(*all_samples)))
    return list(type_table(learned, duration))


def documents(document, rate=1.0, key="robot/r1/battery"):
    return regular(key, rate, lambda i: json_bytes(**document(i)), 20.0)


def test_it_says_what_was_seen_and_why():
    """A line for people, then a table; the place for the weight is marked."""
    battery = {"charge": 0.5}, {"charge": 0.25}
    lines = table(*(documents(lambda i: battery[i % 2], key=f"robot/{name}/battery") for name in ("r1", "r2")))
    assert lines[0] == "# battery: 2 streams, each 1 Hz and 16 B (15 B to 16 B), 250 bit/s in all: JSON."
    read = tomllib.loads("\n".join(lines))["information_type"][0]
    assert read == {
        "name": "battery",
        "keys": ["robot/*/battery"],
        "weight": 1.0,
        "aggregation": "most_recent",
        "utility": {"kind": "linear", "slope": 0.1},
        "forecast": {"size": "16 B", "streams": 2},
    }
    (weight,) = [line for line in lines if line.startswith("weight")]
    assert weight.endswith("# SET WHAT MATTERS MOST HERE, against the other types")


def test_what_could_matter_is_there_to_be_uncommented():
    """With the range seen, the median as default, and the method that erred least."""
    lines = table(documents(lambda i: {"charge": 0.5 - i / 100, "low": i == 5, "model": "A"}))
    assert any(
        line.startswith('#features.charge = { kind = "json", path = "charge", default = 0.405 }') for line in lines
    )
    assert any(line.endswith("# 0.31 to 0.5") for line in lines)
    assert any(line.startswith('#scale = "1 + 10 * low"') for line in lines)
    assert "# Left out: model (constant)." in lines
    rising = table(documents(lambda i: {"charge": 0.5 - i / 100}))
    assert any(line.startswith('#forecast.features = "trend"') for line in rising)
    assert any(line.startswith('#scale = "1 + 10 * clamp((charge - 0.31) / 0.19, 0, 1)"') for line in rising)


@pytest.mark.parametrize(
    ("value", "scale"),
    [
        (lambda i: (i % 3) / 2, "1 + 10 * x"),
        (lambda i: i % 3 * 7, "1 + 10 * clamp(x / 14, 0, 1)"),
        (lambda i: i % 3 - 1, "1 + 10 * clamp((x + 1) / 2, 0, 1)"),
        (lambda i: i % 3 + 1, "1 + 10 * clamp((x - 1) / 2, 0, 1)"),
    ],
)
def test_scales_go_from_what_was_least_to_what_was_greatest(value, scale):
    """From 1 to 11."""
    (line,) = [line for line in table(documents(lambda i: {"x": value(i)})) if line.startswith("#scale")]
    assert line.startswith(f'#scale = "{scale}"')


def test_outliers_are_told_from_the_rest():
    """Where most values are in a small part of the range."""
    lines = table(regular("k", 1.0, lambda i: json_bytes(x=100 if i == 7 else 0.1 * (i % 4)), 60.0))
    assert any(line.endswith("# 0 to 100, mostly 0 to 0.3") for line in lines)


def varying(i):
    return {f"x{n}": -i * (n + 1) for n in range(MOST_FEATURES + 3)}


def test_no_more_features_are_proposed_than_one_reads():
    """The others are named, and of these so many."""
    lines = table(
        documents(lambda i: {f"x{n}": -i * (n + 1) for n in range(MOST_FEATURES + 3)} | {f"c{n}": 1 for n in range(12)})
    )
    assert sum(line.startswith("#features.") for line in lines) == MOST_FEATURES
    (more,) = [line for line in lines if line.startswith("# More that varies: ")]
    assert more.count(", ") == 2
    assert "\n".join(lines).endswith(f" and {12 - MOST_NAMES} more (constant).")


def test_keys_without_a_pattern_are_listed():
    """One a line."""
    lines = [*documents(lambda _: {}, key="r/0123abcd"), *documents(lambda _: {}, key="r/4567cdef")]
    others = documents(lambda _: {"x": 1, "y": 2}, key="r/pose")
    types = named(kinds_of(streams_of(lines[:20], lines[20:], others)))
    text = "\n".join(type_table(next(each for each in types if len(each.kind.keys) == 2), 20.0))
    assert tomllib.loads(text)["information_type"][0]["keys"] == ["r/0123abcd", "r/4567cdef"]


def test_messages_that_cannot_be_read_say_what_it_takes():
    """Those of ROS 2 whose type is not known."""
    lines = table(regular("0/thing/team_msgs::msg::dds_::Thing_/RIHS01_1", 1.0, lambda _: b"\0\1\0\0abcd"))
    assert "\n".join(lines).replace("\n# ", " ").endswith(UNREAD)


def test_what_came_once_has_no_rate():
    """Nor what came at one moment."""
    assert table(regular("map", 1.0, lambda _: b"\xff" * 4100, 1.0))[0] == (
        "# map: 1 stream, once and 4.1 kB: bytes of unknown meaning."
    )
    assert ", 5 Hz and" in table(regular("r/camera", 5.0, lambda i: PICTURES[i % 2]))[0]
