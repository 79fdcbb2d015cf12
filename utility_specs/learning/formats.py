"""What payloads are: recognised by how they begin, by their encoding, and by the keys of ROS 2."""

import json
import re
from typing import Any, Literal

import msgpack

from utility_specs.features.ros_types import typestore
from utility_specs.learning.observed import Observed

Format = Literal["json", "msgpack", "image", "cdr", "ros_image", "text", "raw"]

_RMW = re.compile(
    r"[^/]+/(?P<topic>.+)/(?P<package>\w+)::(?P<kind>msg|srv|action)::dds_::(?P<type>\w+)_/[^/]+", re.ASCII
)
"""A key of rmw_zenoh: domain, topic, type, and the hash of the type."""

IMAGES = {"sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"}
_PICTURES = (b"\xff\xd8\xff", b"\x89PNG\r\n\x1a\n")
_CDR = {b"\x00\x00", b"\x00\x01"}
_LARGEST_TEXT = 1024 * 1024


def ros_topic(key: str) -> str | None:
    """Return the topic of a key of `rmw_zenoh`, None for all other keys."""
    found = _RMW.fullmatch(key)
    return found["topic"] if found else None


def ros_type(key: str) -> str | None:
    """Return the type that a key of `rmw_zenoh` names, such as `sensor_msgs/msg/Image`; None for all other keys."""
    found = _RMW.fullmatch(key)
    return f"{found['package']}/{found['kind']}/{found['type']}" if found else None


def recognised(sample: Observed) -> tuple[Format, Any]:
    """Return what a payload is, and its document if it is one that can be read, else None."""
    payload, kind = sample.payload, ros_type(sample.key)
    if payload.startswith(_PICTURES) or (payload[:4] == b"RIFF" and payload[8:12] == b"WEBP"):
        return "image", None
    if kind is not None or "cdr" in sample.encoding:
        return ("ros_image", None) if kind in IMAGES else ("cdr", _ros_message(payload, kind))
    for form, read in (("json", _json), ("msgpack", _msgpack)):
        document = read(payload)
        if document is not None:
            return form, document  # type: ignore[return-value] # of the two names above
    if payload[:2] in _CDR and len(payload) >= 8 and len(payload) % 4 == 0 and payload[2:4] == b"\x00\x00":
        return "cdr", None
    return ("text" if _is_text(payload) else "raw"), None


def _ros_message(payload: bytes, kind: str | None) -> Any:
    """Return the message; None where its type is not known, the package rosbags is lacking, or it is broken."""
    if kind is None or payload[:2] not in _CDR:
        return None
    try:
        return typestore("jazzy", kind, None).deserialize_cdr(payload, kind)
    except Exception:  # noqa: BLE001 - payloads are broken in every way
        return None


def _json(payload: bytes) -> Any:
    """Return a table, an array or a number; None for all else."""
    if len(payload) > _LARGEST_TEXT:
        return None
    try:
        document = json.loads(payload)
    except (ValueError, RecursionError):
        return None
    return document if isinstance(document, dict | list | int | float) else None


def _msgpack(payload: bytes) -> Any:
    """Return a table or an array that is the whole payload; None for all else."""
    if len(payload) > _LARGEST_TEXT or len(payload) < 2:
        return None
    try:
        document = msgpack.unpackb(payload, strict_map_key=False, unicode_errors="replace")
    except Exception:  # noqa: BLE001 - unpacking raises many kinds, for any bytes
        return None
    return document if isinstance(document, dict | list) and document else None


def _is_text(payload: bytes) -> bool:
    try:
        return bool(payload) and payload[:4096].decode(errors="strict").isprintable()
    except UnicodeDecodeError:
        return False
