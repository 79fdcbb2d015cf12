"""The types of ROS 2."""

import sys

import pytest

from utility_specs.features.path import steps_of
from utility_specs.features.ros_types import check_number, field_of, typestore

DETECTION = """\
std_msgs/Header header
Box[] boxes
float32[3] color
================================================================================
MSG: team_msgs/Box
float32 score
string label
"""


@pytest.mark.parametrize(
    ("name", "field"),
    [
        ("sensor_msgs/msg/BatteryState", "percentage"),
        ("sensor_msgs/msg/BatteryState", "cell_voltage[0]"),
        ("geometry_msgs/msg/PoseStamped", "pose.position.x"),
        ("geometry_msgs/msg/PoseWithCovariance", "covariance[35]"),
        ("nav_msgs/msg/Path", "poses[*].pose.position.x"),
        ("sensor_msgs/msg/LaserScan", "ranges"),
        ("std_msgs/msg/Bool", "data"),
    ],
)
def test_a_field_is_found(name, field):
    """In messages within messages, in arrays of fixed and any length."""
    field_of(typestore("jazzy", name, None), name, steps_of(field))


@pytest.mark.parametrize(
    ("field", "message"),
    [
        ("percentge", r'sensor_msgs/msg/BatteryState has no field "percentge" \(did you mean "percentage"\?\)'),
        ("header.stamp.secs", r'builtin_interfaces/msg/Time has no field "secs" \(did you mean "sec"\?\)'),
        ("percentage.x", 'a float32 has no field "x"'),
        ("cell_voltage.x", r'before "x" there is an array: write \[0\] or \[\*\]'),
        ("header[0]", 'std_msgs/msg/Header has no field "0"'),
    ],
)
def test_a_field_that_is_not_there_is_refused(field, message):
    """With the type that lacks it."""
    name = "sensor_msgs/msg/BatteryState"
    with pytest.raises(ValueError, match=message):
        field_of(typestore("jazzy", name, None), name, steps_of(field))


@pytest.mark.parametrize(
    ("field", "message"),
    [
        ("cell_voltage", "is an array: add an index, or reduce"),
        ("header", "is a std_msgs/msg/Header: name a field of it"),
        ("location", 'is text: add equals = "…"'),
    ],
)
def test_a_field_that_is_no_number_is_refused(field, message):
    """An array, a message, a text."""
    name = "sensor_msgs/msg/BatteryState"
    found = field_of(typestore("jazzy", name, None), name, steps_of(field))
    with pytest.raises(ValueError, match=message):
        check_number(found, compared=False, reduction=None)


@pytest.mark.parametrize(
    ("field", "compared", "reduction"),
    [
        ("voltage", False, None),
        ("present", False, None),
        ("location", True, None),
        ("location", False, "length"),
        ("cell_voltage", False, "mean"),
        ("cell_voltage[0]", False, None),
    ],
)
def test_a_field_becomes_a_number(field, compared, reduction):
    """As it is, by comparison or by reduction."""
    name = "sensor_msgs/msg/BatteryState"
    check_number(
        field_of(typestore("jazzy", name, None), name, steps_of(field)), compared=compared, reduction=reduction
    )


def test_messages_in_an_array_can_only_be_counted():
    """For all else a field of them is needed."""
    found = field_of(typestore("jazzy", "nav_msgs/msg/Path", None), "nav_msgs/msg/Path", steps_of("poses"))
    check_number(found, compared=False, reduction="length")
    with pytest.raises(ValueError, match="is a geometry_msgs/msg/PoseStamped"):
        check_number(found, compared=False, reduction="max")


def test_a_definition_adds_types():
    """For whom it is given, and for nobody else."""
    store = typestore("humble", "team_msgs/msg/Detections", DETECTION)
    field_of(store, "team_msgs/msg/Detections", steps_of("boxes[*].score"))
    with pytest.raises(ValueError, match='unknown type "team_msgs/msg/Detections"; add a definition of it'):
        typestore("humble", "team_msgs/msg/Detections", None)


@pytest.mark.parametrize(
    ("name", "definition", "message"),
    [
        ("sensor_msgs/msg/BateryState", None, 'did you mean "sensor_msgs/msg/BatteryState"'),
        ("a/msg/B", "float32 x\nother/Odd y\n", 'the definition uses "other/msg/Odd", which is not known'),
        ("a/msg/B", "float32 = = 3", "the definition cannot be used: Could not parse"),
        ("std_msgs/msg/Bool", "float64 data\n", "the definition cannot be used: Type 'std_msgs/msg/Bool' is already"),
        ("a/msg/B", "float64 x\na/B[] more\n", "the definition cannot be used: a type is in itself"),
    ],
)
def test_types_that_cannot_be_used_are_refused(name, definition, message):
    """With what is wrong."""
    with pytest.raises(ValueError, match=message):
        typestore("jazzy", name, definition)


def test_without_rosbags_it_says_what_to_install(monkeypatch):
    """When the spec is loaded, and not before."""
    monkeypatch.setitem(sys.modules, "rosbags.typesys", None)
    with pytest.raises(ValueError, match=r"^needs the package rosbags: pip install rosbags \(or"):
        typestore.__wrapped__("jazzy", "std_msgs/msg/Bool", None)
