"""The specs to start from: what they make of real samples."""

import json
import re
from importlib.resources import as_file, files

import msgpack
import numpy as np
import pytest

from planner.problem import Aggregation
from planner.utility import Exponential, Linear, Polynomial, Step, Video
from tests.utility_specs.features.scenes import checked, encoded, ros_compressed
from utility_specs import Specs, load_specs

READY = sorted(file.name for file in files("utility_specs").iterdir() if file.name.endswith(".toml"))
HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"


def spec(name: str) -> Specs:
    with as_file(files("utility_specs") / f"{name}.toml") as path:
        return load_specs(path)


def scale(specs: Specs, key: str, payload: bytes) -> float:
    """The worth of a sample as the daemon finds it."""
    kind = specs.match(key)
    assert kind is not None
    value = kind.scale(kind.extract(key, payload))
    assert kind.failures.counts() == {}
    return value


def test_there_are_specs_for_the_usual_missions():
    """And nothing that no test knows."""
    assert READY == [
        "map_fragments.toml",
        "ros2.toml",
        "search_and_rescue.toml",
        "surveillance.toml",
        "telemetry.toml",
    ]


@pytest.mark.parametrize("name", READY)
def test_each_says_how_to_adapt_it(name):
    """It begins with what it is for, and what to change."""
    text = (files("utility_specs") / name).read_text()
    comment = text[: text.index("version = 1")].removeprefix("#:schema ./sendworthy.schema.json\n")
    assert comment.startswith("# ")
    assert "# To adapt it:\n#   - " in comment


def test_telemetry_of_who_moves_and_who_runs_low_is_worth_more():
    """A pose by the speed in it, a battery by its charge; payloads without them count as usual."""
    specs = spec("telemetry")
    pose, battery = specs.match("robot/r1/pose"), specs.match("robot/r1/battery")
    assert (pose.utility, battery.utility) == (Polynomial(u0=1.0, a1=3.0, k=2), Exponential(u0=1.0, tau=60.0))
    assert scale(specs, "robot/r1/pose", json.dumps({"x": 3, "velocity": 1.8}).encode()) == pytest.approx(2.0)
    low, full = (scale(specs, "robot/r1/battery", json.dumps({"charge": c}).encode()) for c in (0.1, 0.9))
    assert (low, full) == (5.0, 0.5)
    assert pose.scale(pose.extract("robot/r1/pose", b"no JSON")) == pytest.approx(1.2)


def test_a_map_fragment_counts_once_by_what_is_known_in_it():
    """Each fragment is a stream of its own."""
    specs = spec("map_fragments")
    kind = specs.match("robot/r1/map/12/7")
    assert (kind.aggregation, kind.utility) == (Aggregation.ONCE, Step(u0=1.0, lifetime=600.0))
    assert scale(specs, "robot/r1/map/12/7", msgpack.packb({"known": 0.9, "cells": b"..."})) == pytest.approx(1.0)


def test_a_finding_outweighs_every_image():
    """However much there is to see; and it is expected at random."""
    specs = spec("search_and_rescue")
    finding, camera = specs.match("robot/r1/finding"), specs.match("robot/r1/camera")
    assert (finding.aggregation, camera.utility) == (Aggregation.SUM, Video())
    assert specs.match("robot/r1/distress").aggregation is Aggregation.ONCE
    orange = np.full((48, 64, 3), (0, 128, 255), np.uint8)
    gaudy = scale(specs, "robot/r1/camera", encoded(orange))
    dull = scale(specs, "robot/r2/camera", encoded(checked(100, 120)))
    sure = scale(specs, "robot/r1/finding", json.dumps({"confidence": 0.8}).encode())
    assert (dull, sure) == (pytest.approx(0.7), 800.0)
    assert dull * 10 < gaudy < sure / 10


@pytest.mark.parametrize(
    ("topic", "message", "name", "utility"),
    [
        ("r1/front/image/compressed", "sensor_msgs::msg::dds_::CompressedImage_", "images", Video()),
        ("odom", "nav_msgs::msg::dds_::Odometry_", "positions", Polynomial(u0=1.0, a1=3.0, k=2)),
        ("r1/gps/fix", "sensor_msgs::msg::dds_::NavSatFix_", "positions", Polynomial(u0=1.0, a1=3.0, k=2)),
        ("scan", "sensor_msgs::msg::dds_::LaserScan_", "scans", Linear(u0=1.0, slope=0.5)),
        ("r1/lidar/points", "sensor_msgs::msg::dds_::PointCloud2_", "clouds", Linear(u0=1.0, slope=0.2)),
        ("battery_state", "sensor_msgs::msg::dds_::BatteryState_", "batteries", Exponential(u0=1.0, tau=60.0)),
        ("map", "nav_msgs::msg::dds_::OccupancyGrid_", "maps", Exponential(u0=1.0, tau=60.0)),
        ("diagnostics", "diagnostic_msgs::msg::dds_::DiagnosticArray_", "diagnostics", Linear(u0=1.0, slope=0.1)),
    ],
)
def test_topics_of_ros_2_are_known_by_their_types(topic, message, name, utility):
    """Whatever they are called, with or without a namespace."""
    kind = spec("ros2").match(f"0/{topic}/{message}/{HASH}")
    assert (kind.name, kind.utility) == (name, utility)


def test_other_topics_of_ros_2_pass():
    """No type covers what nobody thought of."""
    assert spec("ros2").match(f"0/chatter/std_msgs::msg::dds_::String_/{HASH}") is None


def test_images_of_ros_2_are_worth_what_changes():
    """The message around the image is understood."""
    specs = spec("ros2")
    key = f"0/r1/image/compressed/sensor_msgs::msg::dds_::CompressedImage_/{HASH}"
    first, second = (ros_compressed(encoded(checked(*greys))) for greys in ((0, 255), (255, 0)))
    assert scale(specs, key, first) == pytest.approx(0.75)
    assert scale(specs, key, first) == pytest.approx(0.25)
    assert scale(specs, key, second) == pytest.approx(1.25, abs=0.05)


def test_the_battery_of_ros_2_can_be_read(tmp_path):
    """What its comment says works as it stands."""
    from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415 - an extra

    text = (files("utility_specs") / "ros2.toml").read_text()
    advice = re.search(r"# With rosbags.*?:\n((?:#     .*\n)+)", text)
    lines = "".join(line.removeprefix("#     ") for line in advice[1].splitlines(keepends=True))
    (tmp_path / "ros2.toml").write_text(text.replace('name = "batteries"\n', f'name = "batteries"\n{lines}'))
    specs = load_specs(tmp_path)
    store = get_typestore(Stores.ROS2_JAZZY)
    kind = store.types["sensor_msgs/msg/BatteryState"]
    stamp = store.types["builtin_interfaces/msg/Time"](sec=0, nanosec=0)
    header = store.types["std_msgs/msg/Header"](stamp=stamp, frame_id="")
    none = np.array([], np.float32)
    battery = kind(header, 12.0, 20.0, 0.0, 0.0, 0.0, 0.0, 0.15, 0, 0, 0, True, none, none, "", "")
    payload = bytes(store.serialize_cdr(battery, "sensor_msgs/msg/BatteryState"))
    assert scale(specs, f"0/battery_state/sensor_msgs::msg::dds_::BatteryState_/{HASH}", payload) == 5.0
