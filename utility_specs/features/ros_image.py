"""The two image messages of ROS 2, read from CDR without a copy of their pixels."""

import struct
from dataclasses import dataclass

from utility_specs.errors import FeatureError

_STAMP = 8
"""Bytes of the time in a header."""


@dataclass(frozen=True, slots=True)
class RosImage:
    """A raw image; `step` are the bytes of a row, 0: as many as its pixels take."""

    height: int
    width: int
    encoding: str
    big_endian: bool
    step: int
    data: bytes | memoryview


class _Cdr:
    """Reads plain CDR from its beginning; raises FeatureError or struct.error where there is not what should be."""

    def __init__(self, payload: bytes) -> None:
        if payload[:2] not in {b"\x00\x00", b"\x00\x01"}:
            raise FeatureError("not a CDR message")
        self._order = "<" if payload[1] else ">"
        self._body = memoryview(payload)[4:]
        self._at = 0

    def skip(self, size: int) -> None:
        """Leave out bytes."""
        self._at += size

    def uint32(self) -> int:
        """Read a whole number of four bytes, aligned to them."""
        self._at += -self._at % 4
        (value,) = struct.unpack_from(self._order + "I", self._body, self._at)
        self._at += 4
        return int(value)

    def uint8(self) -> int:
        """Read a byte."""
        value = self.sequence(1)
        return value[0]

    def sequence(self, size: int) -> memoryview:
        """Read so many bytes."""
        found = self._body[self._at : self._at + size]
        if len(found) < size:
            raise FeatureError(f"a CDR message is cut off: {len(found)} B of {size} B")
        self._at += size
        return found

    def string(self) -> str:
        """Read a string."""
        return bytes(self.sequence(self.uint32())).rstrip(b"\0").decode()

    def header(self) -> None:
        """Read over a `std_msgs/msg/Header`."""
        self.skip(_STAMP)
        self.string()


def image_in(payload: bytes) -> RosImage:
    """Read a `sensor_msgs/msg/Image`."""
    cdr = _Cdr(payload)
    cdr.header()
    height, width, encoding = cdr.uint32(), cdr.uint32(), cdr.string()
    big_endian, step = bool(cdr.uint8()), cdr.uint32()
    return RosImage(height, width, encoding, big_endian, step, cdr.sequence(cdr.uint32()))


def compressed_in(payload: bytes) -> memoryview:
    """Return the compressed image in a `sensor_msgs/msg/CompressedImage`."""
    cdr = _Cdr(payload)
    cdr.header()
    cdr.string()
    return cdr.sequence(cdr.uint32())
