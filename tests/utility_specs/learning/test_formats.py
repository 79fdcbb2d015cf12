"""What payloads are."""

import msgpack
import pytest

from tests.utility_specs.features.scenes import checked, encoded
from tests.utility_specs.features.test_cdr import battery
from utility_specs.learning import Observed
from utility_specs.learning.formats import recognised, ros_topic, ros_type

HASH = "RIHS01_df66"
ROS_BATTERY = f"0/r1/battery/sensor_msgs::msg::dds_::BatteryState_/{HASH}"
IMAGE = checked(0, 255)


@pytest.mark.parametrize(
    ("payload", "form"),
    [
        (encoded(IMAGE, ".jpg"), "image"),
        (encoded(IMAGE, ".png"), "image"),
        (encoded(IMAGE, ".webp"), "image"),
        (b'{"charge": 0.5}', "json"),
        (b"[1, 2]", "json"),
        (b"3.7", "json"),
        (b"true", "json"),
        (msgpack.packb({"charge": 0.5}), "msgpack"),
        (msgpack.packb([1.0, 2.0]), "msgpack"),
        (b"\x00\x01\x00\x00abcdefgh", "cdr"),
        (b"all is well", "text"),
        (b'"quoted"', "text"),
        (b"", "raw"),
        (b"\x07", "raw"),
        (b"\xff\xfe\xfd", "raw"),
        (b"\x00\x01\x00\x00abc", "raw"),
        (b"[" * 100_000, "text"),
        (b" " * 2**20 + b"[1]", "text"),
        (b"\x80" + b"\x00" * 2**20, "raw"),
    ],
)
def test_payloads_are_recognised(payload, form):
    """By how they begin, and by what can be read."""
    assert recognised(Observed(0.0, "k", payload))[0] == form


def test_documents_come_with_it():
    """What was read once is not read again."""
    assert recognised(Observed(0.0, "k", b'{"a": 1}')) == ("json", {"a": 1})
    assert recognised(Observed(0.0, "k", msgpack.packb({"a": 1}))) == ("msgpack", {"a": 1})


def test_messages_of_ros_are_read_by_the_type_in_their_key():
    """Of types of ROS 2 itself; of others, and of broken messages, no more is known than that."""
    form, message = recognised(Observed(0.0, ROS_BATTERY, battery(0.25)))
    assert (form, message.percentage) == ("cdr", 0.25)
    for key, payload in (
        (ROS_BATTERY, battery()[:20]),
        (ROS_BATTERY, b"{}"),
        (f"0/r1/thing/team_msgs::msg::dds_::Thing_/{HASH}", b"\0\1\0\0abcd"),
    ):
        assert recognised(Observed(0.0, key, payload)) == ("cdr", None)
    assert recognised(Observed(0.0, "battery", battery(), "application/cdr")) == ("cdr", None)


def test_images_of_ros_are_images():
    """They are not read as messages."""
    key = f"0/r1/image/sensor_msgs::msg::dds_::CompressedImage_/{HASH}"
    assert recognised(Observed(0.0, key, b"\0\1\0\0")) == ("ros_image", None)


def test_keys_of_ros_tell_topic_and_type():
    """Those of rmw_zenoh; all others tell nothing."""
    assert (ros_topic(ROS_BATTERY), ros_type(ROS_BATTERY)) == ("r1/battery", "sensor_msgs/msg/BatteryState")
    assert ros_topic("robot/r1/battery") is None
    assert ros_type("robot/r1/battery") is None
