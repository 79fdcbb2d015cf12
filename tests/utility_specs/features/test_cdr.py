"""Numbers in messages of ROS 2."""

import math
import os

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from tests.utility_specs.features.test_ros_types import DETECTION
from utility_specs.features import AnyFeatureTable
from utility_specs.features.cdr import LARGEST_DEFINITION, CdrTable
from utility_specs.features.sample import Sample

STORE = get_typestore(Stores.ROS2_JAZZY)
STORE.register(get_types_from_msg(DETECTION, "team_msgs/msg/Detections"))
TYPES = STORE.types
HEADER = TYPES["std_msgs/msg/Header"](TYPES["builtin_interfaces/msg/Time"](12, 34), "base_link")
BATTERY = "sensor_msgs/msg/BatteryState"
SCAN = "sensor_msgs/msg/LaserScan"


def packed(name: str, *fields) -> bytes:
    return bytes(STORE.serialize_cdr(TYPES[name](*fields), name))


def battery(percentage: float = 0.25) -> bytes:
    volts, none = np.array([3.5, 4.0], np.float32), np.array([], np.float32)
    return packed(BATTERY, HEADER, 12.5, 20.0, -1.5, 1.0, 2.0, 3.0, percentage, 2, 1, 3, True, volts, none, "bay", "7")


def scan() -> bytes:
    ranges = np.array([math.inf, 2.5, math.nan, 1.5], np.float32)
    return packed(SCAN, HEADER, 0.0, 1.0, 0.5, 0.0, 0.1, 0.1, 10.0, ranges, np.array([], np.float32))


def feature(name: str, field: str, **said):
    return CdrTable(kind="cdr", type=name, field=field, **said).feature()


@pytest.mark.parametrize(
    ("payload", "name", "field", "said", "value"),
    [
        (battery(), BATTERY, "percentage", {}, 0.25),
        (battery(), "sensor_msgs/BatteryState", "current", {}, -1.5),
        (battery(), BATTERY, "present", {}, 1.0),
        (battery(), BATTERY, "header.stamp.sec", {}, 12.0),
        (battery(), BATTERY, "power_supply_status", {"equals": 2}, 1.0),
        (battery(), BATTERY, "location", {"equals": "dock"}, 0.0),
        (battery(), BATTERY, "cell_voltage", {"reduce": "mean"}, 3.75),
        (battery(), BATTERY, "cell_voltage[1]", {}, 4.0),
        (battery(), BATTERY, "cell_temperature", {"reduce": "length"}, 0.0),
        (scan(), SCAN, "ranges", {"reduce": "min"}, 1.5),
        (scan(), SCAN, "ranges", {"reduce": "length"}, 4.0),
    ],
)
def test_a_field_is_read(payload, name, field, said, value):
    """From what ROS 2 sends."""
    assert feature(name, field, **said).measure(Sample("k", payload)) == value


def test_a_type_of_ones_own_is_read(tmp_path):
    """Its definition stands beside the spec, and is a part of it; or is written in it."""
    (tmp_path / "Detections.msg").write_text(DETECTION)
    box = TYPES["team_msgs/msg/Box"]
    boxes = [box(0.25, "person"), box(0.75, "dog")]
    payload = packed("team_msgs/msg/Detections", HEADER, boxes, np.zeros(3, np.float32))
    said = {"type": "team_msgs/msg/Detections", "definition": "Detections.msg", "kind": "cdr"}
    table = TypeAdapter(AnyFeatureTable).validate_python(
        said | {"field": "boxes[*].score", "reduce": "max"}, context={"folder": tmp_path}
    )
    assert table.feature().measure(Sample("k", payload)) == 0.75
    assert table == table.model_validate(table.model_dump())
    assert table.definition == DETECTION


def test_features_decode_a_message_once():
    """They share it through the sample."""
    sample = Sample("k", battery())
    one, other = feature(BATTERY, "percentage"), feature(BATTERY, "voltage")
    assert (one.measure(sample), other.measure(sample)) == (0.25, 12.5)
    assert len(sample._made) == 1


@pytest.mark.parametrize("length", [0, 3, 4, 8, 20, 40])
def test_a_message_that_is_cut_off_has_no_value(length):
    """The caller then takes the default."""
    with pytest.raises(ValueError, match="k: "):
        feature(BATTERY, "percentage").measure(Sample("k", battery()[:length]))


def test_what_is_no_number_is_told_to_the_caller():
    """ROS 2 says NaN where a battery is not known."""
    assert math.isnan(feature(BATTERY, "percentage").measure(Sample("k", battery(math.nan))))


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ({"type": "BatteryState"}, '"BatteryState" is not a type; write for example "sensor_msgs/msg/BatteryState"'),
        ({"type": "sensor_msgs/msg/BateryState"}, "did you mean"),
        ({"field": "percentge"}, "did you mean"),
        ({"field": "cell_voltage[*]"}, "there are many values"),
        ({"field": "cell_voltage"}, "is an array"),
        ({"distro": "melodic"}, "Input should be"),
        ({"definition": "absent.msg"}, 'cannot read "absent.msg": No such file or directory'),
    ],
)
def test_a_table_that_cannot_work_is_refused(said, message):
    """When the spec is loaded."""
    with pytest.raises(ValidationError, match=message):
        CdrTable.model_validate({"kind": "cdr", "type": BATTERY, "field": "percentage"} | said)


def test_a_definition_that_never_ends_is_refused(tmp_path):
    """Such as a pipe that nobody writes into."""
    os.mkfifo(tmp_path / "A.msg")
    table = {"kind": "cdr", "type": "a/msg/A", "field": "x", "definition": "A.msg"}
    with pytest.raises(ValidationError, match="it is not a file"):
        CdrTable.model_validate(table, context={"folder": tmp_path})


@pytest.mark.parametrize(("text", "message"), [(b"#" * (LARGEST_DEFINITION + 1), "is larger than"), (b"\xff", "utf-8")])
def test_a_definition_that_cannot_be_read_is_refused(text, message, tmp_path):
    """Too large, or not text."""
    (tmp_path / "A.msg").write_bytes(text)
    table = {"kind": "cdr", "type": "a/msg/A", "field": "x", "definition": "A.msg"}
    with pytest.raises(ValidationError, match=message):
        CdrTable.model_validate(table, context={"folder": tmp_path})
