"""From bytes to pixels: images as cameras send them, decoded small and once for all features that read them."""

import importlib
import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

from utility_specs.errors import FeatureError
from utility_specs.features.ros_image import RosImage, compressed_in

LARGEST_IMAGE = 2**25
"""Pixels of the largest image that is decoded: a small payload may claim to be enormous.

Twice as many take 464 MB as a progressive JPEG, and the service has 400 MB.
"""

JPEG = b"\xff\xd8\xff"
PNG = b"\x89PNG\r\n\x1a\n"
BEGINNINGS = (JPEG, PNG, b"RIFF", b"BM")
"""What compressed images begin with: JPEG, PNG, WebP, BMP. OpenCV reads more kinds, in ways that are less tried."""

Reduction = Literal[1, 2, 4, 8]

SCAN = b"\xff\xda"
"""What each scan of a JPEG begins with; its data hold no such bytes."""
MOST_SCANS = 20
"""Scans of a JPEG at most. Progressive ones have about ten, and each goes over the whole image: 200 took 49 s."""

_AROUND_CHUNK = 12
"""Bytes of a chunk of a PNG besides what it carries: its length, its name, its checksum."""
_PACKED_TEXT = (b"zTXt", b"iTXt")
"""Chunks of a PNG that say nothing of its pixels and are unpacked all the same: a hundred of 8 kB took 20 s."""

Pixels = Any
"""A NumPy array of bytes: height x width x 3 (blue, green, red), or height x width of a grey image."""


@dataclass(frozen=True, slots=True)
class Encoding:
    """How rows of raw pixels are laid out, and what makes them blue, green and red (none: they are, or are grey).

    `mosaic`: neighbours belong together, so that nothing can be scaled before colours are made.
    """

    channels: int = 1
    bits: Literal[8, 16] = 8
    conversion: str | None = None
    mosaic: bool = False
    rows: float = 1.0
    """Rows of bytes for each row of the image."""

    def uneven(self, width: int, height: int) -> bool:
        """Whether no image has these sides: two pixels beside, or below, each other share a colour."""
        planar = self.rows != 1.0
        return bool((width % 2 and (planar or self.channels == 2)) or (height % 2 and planar))

    def shape(self, width: int, height: int) -> tuple[int, ...]:
        """Return the shape of the array of an image."""
        rows = round(height * self.rows)
        return (rows, width) if self.channels == 1 else (rows, width, self.channels)


ENCODINGS: Mapping[str, Encoding] = {
    "bgr8": Encoding(3),
    "rgb8": Encoding(3, conversion="COLOR_RGB2BGR"),
    "bgra8": Encoding(4, conversion="COLOR_BGRA2BGR"),
    "rgba8": Encoding(4, conversion="COLOR_RGBA2BGR"),
    "mono8": Encoding(),
    "mono16": Encoding(bits=16),
    "8UC1": Encoding(),
    "8UC3": Encoding(3),
    "16UC1": Encoding(bits=16),
    "yuv422": Encoding(2, conversion="COLOR_YUV2BGR_UYVY", mosaic=True),
    "uyvy": Encoding(2, conversion="COLOR_YUV2BGR_UYVY", mosaic=True),
    "yuv422_yuy2": Encoding(2, conversion="COLOR_YUV2BGR_YUY2", mosaic=True),
    "yuyv": Encoding(2, conversion="COLOR_YUV2BGR_YUY2", mosaic=True),
    "nv12": Encoding(conversion="COLOR_YUV2BGR_NV12", mosaic=True, rows=1.5),
    "nv21": Encoding(conversion="COLOR_YUV2BGR_NV21", mosaic=True, rows=1.5),
    "i420": Encoding(conversion="COLOR_YUV2BGR_I420", mosaic=True, rows=1.5),
    "bayer_rggb8": Encoding(conversion="COLOR_BayerRGGB2BGR", mosaic=True),
    "bayer_bggr8": Encoding(conversion="COLOR_BayerBGGR2BGR", mosaic=True),
    "bayer_gbrg8": Encoding(conversion="COLOR_BayerGBRG2BGR", mosaic=True),
    "bayer_grbg8": Encoding(conversion="COLOR_BayerGRBG2BGR", mosaic=True),
}
"""What raw images may be encoded in: the names of ROS 2, and of V4L2 where ROS has none."""


@cache
def opencv() -> tuple[Any, Any]:
    """Return OpenCV and NumPy, imported when the first spec needs them."""
    # OpenCV reads these when it is imported. What it cannot decode is counted; it would fill the log with it.
    os.environ.setdefault("OPENCV_IO_MAX_IMAGE_PIXELS", str(LARGEST_IMAGE))
    os.environ.setdefault("OPENCV_LOG_LEVEL", "SILENT")
    return importlib.import_module("cv2"), importlib.import_module("numpy")


def decoded(payload: bytes | memoryview, reduction: Reduction) -> Pixels:
    """Decode a JPEG, PNG, WebP or BMP, its sides `reduction` times as short.

    Of a JPEG that takes less time. Raises FeatureError or OpenCV's own error for what is not an image.
    """
    cv2, numpy = opencv()
    payload = bytes(payload)
    if not payload.startswith(BEGINNINGS) or (payload.startswith(JPEG) and payload.count(SCAN) > MOST_SCANS):
        raise FeatureError("the payload is not an image")
    payload = _without_texts(payload) if payload.startswith(PNG) else payload
    flag = "IMREAD_COLOR" if reduction == 1 else f"IMREAD_REDUCED_COLOR_{reduction}"
    image = cv2.imdecode(numpy.frombuffer(payload, numpy.uint8), getattr(cv2, flag))
    if image is None:
        raise FeatureError("the payload is not an image")
    return image


def _without_texts(payload: bytes) -> bytes:
    """Return a PNG without packed texts; raises FeatureError where a chunk says that it is longer than what follows.

    OpenCV 5.0 would make room for that: 106 bytes took 3 GB and 12 s.
    """
    at = kept = len(PNG)
    parts = [PNG]
    while at < len(payload):
        end = at + int.from_bytes(payload[at : at + 4]) + _AROUND_CHUNK
        if payload[at + 4 : at + 8] in _PACKED_TEXT:
            parts.append(payload[kept:at])
            kept = end
        at = end
    if at > len(payload):
        raise FeatureError("the payload is not an image")
    return b"".join([*parts, payload[kept:]]) if len(parts) > 1 else payload


def of_raw(image: RosImage, reduction: Reduction) -> Pixels:
    """Return the pixels of a raw image, its sides `reduction` times as short; raises FeatureError for a broken one."""
    cv2, _ = opencv()
    encoding = ENCODINGS.get(image.encoding)
    if encoding is None:
        raise FeatureError(f"an image in an unknown encoding: {image.encoding[:40]}")
    pixels = _array(image, encoding)
    if not encoding.mosaic:
        pixels = _reduced(pixels, reduction)
    if encoding.bits == 16:
        pixels = cv2.convertScaleAbs(pixels, alpha=1 / 257)
    if encoding.conversion is not None:
        pixels = cv2.cvtColor(pixels, getattr(cv2, encoding.conversion))
    return _reduced(pixels, reduction) if encoding.mosaic else pixels


def _array(image: RosImage, encoding: Encoding) -> Pixels:
    """Return the bytes of an image as an array, without what pads its rows."""
    _, numpy = opencv()
    shape = encoding.shape(image.width, image.height)
    row = image.width * encoding.channels * encoding.bits // 8
    step = image.step or row
    if not 0 < image.width * image.height <= LARGEST_IMAGE or step < row or len(image.data) < step * shape[0]:
        raise FeatureError(f"{len(image.data)} B are no image of {image.width} x {image.height} {image.encoding}")
    rows = numpy.frombuffer(image.data, numpy.uint8, step * shape[0]).reshape(shape[0], step)[:, :row]
    if encoding.bits == 16:
        kind = ">u2" if image.big_endian else "<u2"
        rows = numpy.ascontiguousarray(rows).view(kind).astype(numpy.uint16)
    return numpy.ascontiguousarray(rows).reshape(shape)


def _reduced(pixels: Pixels, reduction: Reduction) -> Pixels:
    cv2, _ = opencv()
    if reduction == 1:
        return pixels
    height, width = (-(-side // reduction) for side in pixels.shape[:2])
    return cv2.resize(pixels, (width, height), interpolation=cv2.INTER_AREA)


def of_compressed_message(payload: bytes, reduction: Reduction) -> Pixels:
    """Return the pixels of a `sensor_msgs/msg/CompressedImage`."""
    return decoded(compressed_in(payload), reduction)
