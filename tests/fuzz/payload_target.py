"""Payloads and attachments of samples, fuzzed byte by byte: documents, messages of ROS 2, images.

The first byte says which specs cover the sample, the rest is its payload, and its attachment, too.
"""

import json
import math
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import msgpack
import numpy as np

from tests.utility_specs.features.test_cdr import BATTERY, HEADER, TYPES, battery, packed, scan
from utility_specs import Specs, load_specs
from utility_specs.features.pixels import opencv

PLACES = {
    "whole": "",
    "first": 'path = "a[0]"',
    "deep": 'path = "pose.position[0].x"',
    "most": 'path = "seen[*].score", reduce = "max"',
    "mean": 'path = "seen[*].score", reduce = "mean"',
    "long": 'path = "a", reduce = "length"',
    "text": 'path = "mode", equals = "auto"',
}
"""Where features look in documents."""
FIELDS = {
    "cdr/battery": (BATTERY, {"part": '"percentage"', "volts": '"cell_voltage", reduce = "mean"'}),
    "cdr/scan": ("sensor_msgs/msg/LaserScan", {"near": '"ranges", reduce = "min"', "sec": '"header.stamp.sec"'}),
    "cdr/path": ("nav_msgs/msg/Path", {"far": '"poses[*].pose.position.x", reduce = "max"'}),
    "cdr/cloud": ("sensor_msgs/msg/PointCloud2", {"points": '"data", reduce = "length"', "wide": '"width"'}),
    "cdr/diagnostics": (
        "diagnostic_msgs/msg/DiagnosticArray",
        {"bad": '"status[*].name", equals = "bad", reduce = "sum"'},
    ),
}
"""Messages of ROS 2, and what features look at."""
FORMS = {
    "image/compressed": "",
    "image/whole": "downscale = 1",
    "image/raw": 'format = "raw", width = 8, height = 6, encoding = "nv12"',
    "image/bayer": 'format = "raw", width = 8, height = 6, encoding = "bayer_rggb8", downscale = 1',
    "image/ros": 'format = "sensor_msgs/msg/Image"',
    "image/ros-compressed": 'format = "sensor_msgs/msg/CompressedImage"',
}
"""What images are in."""
DOCUMENTS = ("document/json", "document/msgpack", "attached/json", "attached/msgpack", "attached/raw")


PAYLOADS, IMAGES = (*DOCUMENTS, *FIELDS), tuple(FORMS)
"""The keys of all of them."""


def one_payload(data: bytes) -> None:
    """Extract the features of a document, an attachment or a message of ROS 2; raises only what is a fault."""
    _extract(PAYLOADS, data)


def one_image(data: bytes) -> None:
    """Extract the features of an image."""
    _extract(IMAGES, data)


def _extract(keys: tuple[str, ...], data: bytes) -> None:
    key, rest = keys[data[0] % len(keys) if data else 0], data[1:]
    covering = specs().match(key)
    assert covering is not None
    found = covering.extract(key, rest, rest)
    assert found
    assert all(math.isfinite(value) for value in found.values()), found
    scale = covering.scale(found)
    assert math.isfinite(scale)
    assert scale >= 0.0


@cache
def specs() -> Specs:
    """Types with features of all kinds."""
    kinds = {}
    for form in ("json", "msgpack"):
        kinds[f"document/{form}"] = {n: f'kind = "{form}", {p}'.rstrip(", ") for n, p in PLACES.items()}
        kinds[f"attached/{form}"] = {
            n: f'kind = "attachment", format = "{form}", {p}'.rstrip(", ") for n, p in PLACES.items()
        }
    kinds["attached/raw"] = {
        f"n{at}": f'kind = "attachment", format = "{form}", offset = {at}, byte_order = "big"'
        for at, form in enumerate(("uint8", "int32", "float32", "float64", "uint64"))
    }
    for key, (name, fields) in FIELDS.items():
        kinds[key] = {n: f'kind = "cdr", type = "{name}", field = {f}' for n, f in fields.items()}
    for key, form in FORMS.items():
        images = {"red": 'kind = "color_fraction", color = "red"', "light": 'kind = "brightness"'}
        images |= {"sharp": 'kind = "sharpness"', "other": 'kind = "change"'}
        kinds[key] = {n: f"{each}, {form}".rstrip(", ") for n, each in images.items()}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "spec.toml"
        path.write_text("\n".join(_table(key, features) for key, features in kinds.items()))
        return load_specs(path)


def payload_seeds() -> list[bytes]:
    """Documents, attachments and messages to start from, one for each key."""
    place, seen = {"position": [{"x": 3}]}, [{"score": 0.5}, {"score": True}]
    document = {"a": [1, 2.5], "pose": place, "seen": seen, "mode": "auto"}
    documents = json.dumps(document).encode(), msgpack.packb(document)
    messages = battery(), scan(), _path(), _cloud(), _diagnostics()
    return [bytes([at]) + each for at, each in enumerate((*documents, *documents, bytes(range(16)), *messages))]


def _path() -> bytes:
    def made(name: str, *fields: Any) -> Any:
        return TYPES[f"geometry_msgs/msg/{name}"](*fields)

    pose = made("Pose", made("Point", 1.0, 2.0, 3.0), made("Quaternion", 0.0, 0.0, 0.0, 1.0))
    return packed("nav_msgs/msg/Path", HEADER, [made("PoseStamped", HEADER, pose)] * 2)


def _cloud() -> bytes:
    data = np.arange(12, dtype=np.uint8)
    return packed("sensor_msgs/msg/PointCloud2", HEADER, 1, 1, [], False, 12, 12, data, True)


def _diagnostics() -> bytes:
    value = TYPES["diagnostic_msgs/msg/KeyValue"]("rate", "5")
    status = TYPES["diagnostic_msgs/msg/DiagnosticStatus"](1, "bad", "slow", "camera", [value])
    return packed("diagnostic_msgs/msg/DiagnosticArray", HEADER, [status])


def image_seeds() -> list[bytes]:
    """Images to start from, in all forms."""
    cv2, _ = opencv()  # before `scenes` imports it, which sets no bound
    from tests.utility_specs.features.scenes import ros_compressed, ros_image  # noqa: PLC0415

    picture = np.arange(8 * 6 * 3, dtype=np.uint8).reshape(6, 8, 3)
    packed = [cv2.imencode(form, picture)[1].tobytes() for form in (".jpg", ".png", ".webp", ".bmp")]
    found = [bytes([place]) + each for each in packed for place in (0, 1)]
    found += [b"\2" + bytes(72), b"\3" + bytes(48)]
    found += [b"\4" + ros_image(picture, kind) for kind in ("bgr8", "rgb8")]
    return [*found, b"\4" + ros_image(picture[:, :, 0], "mono8"), b"\5" + ros_compressed(packed[0])]


def _table(key: str, features: dict[str, str]) -> str:
    lines = [f"features.{name} = {{ {each} }}" for name, each in features.items()]
    scale = " + ".join(features)
    head = f'[[information_type]]\nname = "{key.replace("/", " ")}"\nkeys = ["{key}"]\nutility = {{ kind = "video" }}'
    return "\n".join((head, f'scale = "{scale}"', *lines, ""))
