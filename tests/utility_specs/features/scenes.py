"""Images of which it is known what features find in them, in the forms that robots send."""

import struct

import cv2
import numpy as np

SIDE = (480, 640)


def checked(low: int, high: int, squares: int = 8) -> np.ndarray:
    """A chessboard of two greys."""
    rows, columns = (np.arange(side) * squares // side % 2 for side in SIDE)
    board = np.where((rows[:, None] + columns[None, :]) % 2, high, low).astype(np.uint8)
    return np.repeat(board[:, :, None], 3, axis=2)


def encoded(image: np.ndarray, form: str = ".png") -> bytes:
    return cv2.imencode(form, image)[1].tobytes()


def message(fields: list[bytes]) -> bytes:
    """A message of ROS 2 with a header and these fields after it, each aligned to four bytes."""
    body = struct.pack("<iI", 1, 2) + struct.pack("<I", 7) + b"camera\0"
    for field in fields:
        body += b"\0" * (-len(body) % 4) + field
    return b"\0\1\0\0" + body


def string(text: str) -> bytes:
    return struct.pack("<I", len(text) + 1) + text.encode() + b"\0"


def ros_image(image: np.ndarray, encoding: str = "bgr8") -> bytes:
    """A `sensor_msgs/msg/Image`."""
    height, width = image.shape[:2]
    data = image.tobytes()
    return message(
        [
            struct.pack("<II", height, width),
            string(encoding) + b"\0",
            struct.pack("<II", len(data) // height, len(data)),
            data,
        ]
    )


def ros_compressed(data: bytes) -> bytes:
    """A `sensor_msgs/msg/CompressedImage`."""
    return message([string("jpeg"), struct.pack("<I", len(data)), data])
