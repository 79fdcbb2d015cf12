"""What all messages have in common: a list in msgpack, whose first field is the version of the protocol.

A version may add fields at the end, which neighbouring versions leave out or do without. What others would misread is
two versions on, and the CHANGELOG says "wire version" and its number.
"""

from typing import Any

import msgpack

from proxy.core.protocol.tuning import TUNING


class MalformedWireError(ValueError):
    """Something on a Sendworthy key that is no digest and no state."""


class OtherVersionError(MalformedWireError):
    """A message in a `version` of the protocol that is not read here."""

    def __init__(self, version: int) -> None:
        super().__init__(f"of version {version} of what daemons tell each other")
        self.version = version


VERSION = 7
OLDEST = 6
"""What older daemons said is another language."""
READABLE = range(max(OLDEST, VERSION - 1), VERSION + 2)
"""The versions that are understood."""


def packed(fields: list[Any]) -> bytes:
    """Return the bytes of a message with these fields after the version."""
    data: bytes = msgpack.packb([VERSION, *fields], use_single_float=True)
    return data


def fields_of(data: bytes, most: int, least: int) -> list[Any]:
    """Return the `least` or more fields of a message of up to `most` bytes; raise `MalformedWireError`."""
    if len(data) > most:
        raise MalformedWireError(f"{len(data)} bytes are more than the {most} that a message may have")
    known_version(*head(data, 1))
    try:
        fields = msgpack.unpackb(
            data, max_array_len=TUNING.digest_bytes, max_map_len=0, max_str_len=TUNING.key_bytes, max_bin_len=32
        )
    except (ValueError, msgpack.UnpackException, RecursionError) as error:
        raise MalformedWireError(f"no msgpack: {error}") from error
    if len(fields) < least:
        raise MalformedWireError(f"{len(fields)} fields where {least} are due")
    return list(fields)


def head(data: bytes, count: int) -> list[object]:
    """Return the first `count` fields of a message, fewer where it has fewer, without looking at the rest."""
    unpacker = msgpack.Unpacker(max_buffer_size=TUNING.head_bytes)
    unpacker.feed(data[: TUNING.head_bytes])
    try:
        length = unpacker.read_array_header()
        return [unpacker.unpack() for _ in range(min(count, length))]
    except (ValueError, msgpack.UnpackException, RecursionError) as error:
        raise MalformedWireError(f"no msgpack: {error}") from error


def known_version(version: object = None) -> int:
    """Return a version that is understood here; raise `OtherVersionError` for another one."""
    if type(version) is not int or version < 0:
        raise MalformedWireError(f"{version!r:.80} is no version")
    if version not in READABLE:
        raise OtherVersionError(version)
    return version
