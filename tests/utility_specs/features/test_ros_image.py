"""The image messages of ROS 2, beside what rosbags makes of them."""

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from tests.utility_specs.features import scenes
from utility_specs.errors import FeatureError
from utility_specs.features.ros_image import compressed_in, image_in

STORE = get_typestore(Stores.ROS2_JAZZY)
IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"


def header(frame: str):
    time = STORE.types["builtin_interfaces/msg/Time"](sec=3, nanosec=4)
    return STORE.types["std_msgs/msg/Header"](stamp=time, frame_id=frame)


@pytest.mark.parametrize("little", [True, False], ids=["little", "big"])
@pytest.mark.parametrize("frame", ["", "a", "camera", "cameras/left"])
@pytest.mark.parametrize("encoding", ["mono8", "bgra8", "yuv422_yuy2"])
def test_a_raw_image_is_read_whatever_its_strings_are_long(encoding, frame, little):
    """Strings move what comes after them; both byte orders."""
    data = np.arange(60, dtype=np.uint8)
    written = STORE.types[IMAGE](header(frame), 3, 5, encoding, 0, 20, data)
    read = image_in(bytes(STORE.serialize_cdr(written, IMAGE, little_endian=little)))
    assert (read.height, read.width, read.encoding, read.big_endian, read.step) == (3, 5, encoding, False, 20)
    assert bytes(read.data) == data.tobytes()


@pytest.mark.parametrize("form", ["jpeg", "png", "rgb8; jpeg compressed bgr8"])
def test_a_compressed_image_is_read(form):
    """Its bytes, whatever the message says of their format."""
    written = STORE.types[COMPRESSED](header("camera"), form, np.arange(7, dtype=np.uint8))
    assert bytes(compressed_in(bytes(STORE.serialize_cdr(written, COMPRESSED)))) == bytes(range(7))


def test_a_message_that_is_cut_off_is_refused():
    """Wherever that is."""
    whole = scenes.ros_image(np.zeros((2, 3, 3), np.uint8))
    assert image_in(whole).encoding == "bgr8"
    for length in range(len(whole)):
        with pytest.raises((FeatureError, struct.error)):
            image_in(whole[:length])


@given(st.binary(max_size=80))
def test_any_bytes_are_a_message_or_an_error(payload):
    """Lengths are never believed."""
    for read in (image_in, compressed_in):
        try:
            read(b"\0\1\0\0" + payload)
        except (FeatureError, struct.error, UnicodeDecodeError):
            continue
