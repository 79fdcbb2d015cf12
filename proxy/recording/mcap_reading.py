"""The records of MCAP files, as far as these go: what is cut off or damaged is told, and left out.

Needs the extra `record`.
"""

import struct
import zlib
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import IO

import zstandard
from lz4.frame import LZ4FrameDecompressor
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Chunk, Header, McapRecord
from mcap.stream_reader import breakup_chunk
from mcap.writer import MCAP0_MAGIC

from proxy.recording.errors import RecordingError
from proxy.recording.tuning import TUNING

DAMAGED = (McapError, RecordingError, OverflowError, RuntimeError, ValueError, struct.error, zstandard.ZstdError)
"""What a damaged chunk or record makes."""
_RECORD = struct.Struct("<BQ")


def records(path: Path, file: IO[bytes], problems: list[str]) -> Iterator[tuple[int, bytes]]:
    """Yield kind and content of the records behind the magic, up to the end of the data, or of what is there.

    `problems` gets a sentence that names `path` where that is too early.
    """
    while True:
        at = file.tell()
        head = file.read(_RECORD.size)
        if len(head) < _RECORD.size:
            if head:
                problems.append(_cut(path, at))
            return
        opcode, length = _RECORD.unpack(head)
        if opcode == Opcode.DATA_END:
            return
        if not opcode or length > TUNING.record:
            problems.append(f"{path} is damaged at byte {at:,} and is read up to there")
            return
        data = file.read(length)
        if len(data) < length:
            problems.append(_cut(path, at))
            return
        yield opcode, data


def is_mcap(file: IO[bytes]) -> bool:
    """Whether a file begins as MCAP does; what comes next is its first record."""
    return file.read(len(MCAP0_MAGIC)) == MCAP0_MAGIC


def profile_of(data: bytes) -> str:
    """Return the profile that a header names; nothing where it is damaged."""
    try:
        return str(Header.read(stream(data)).profile)
    except (McapError, struct.error, UnicodeDecodeError):
        return ""


def in_chunk(data: bytes) -> list[McapRecord]:
    """Return the records of a chunk. Raises what `DAMAGED` has."""
    return breakup_chunk(_plain(Chunk.read(stream(data))))


def stream(data: bytes) -> ReadDataStream:
    """Return what the library reads a record's content from."""
    return ReadDataStream(BytesIO(data))


def _plain(chunk: Chunk) -> Chunk:
    """Return a chunk with its messages unpacked."""
    size = chunk.uncompressed_size
    if size > TUNING.record:
        raise RecordingError(f"it claims to hold {size:,} bytes")
    raw = chunk.data
    if chunk.compression == "zstd":
        told = zstandard.get_frame_parameters(raw).content_size
        if told not in (size, zstandard.CONTENTSIZE_UNKNOWN):
            raise RecordingError("it holds another number of bytes than it says")
        raw = zstandard.ZstdDecompressor().decompress(raw, size)
    elif chunk.compression == "lz4":
        raw = LZ4FrameDecompressor().decompress(raw, size)
    elif chunk.compression:
        raise RecordingError(f'it is packed by "{chunk.compression}", which is not known here')
    if len(raw) != size:
        raise RecordingError("it holds another number of bytes than it says")
    if chunk.uncompressed_crc not in (0, zlib.crc32(raw)):
        raise RecordingError("its checksum is wrong")
    return Chunk(
        compression="",
        data=raw,
        message_end_time=chunk.message_end_time,
        message_start_time=chunk.message_start_time,
        uncompressed_crc=0,
        uncompressed_size=len(raw),
    )


def _cut(path: Path, at: int) -> str:
    return f"{path} is cut off in the middle of a record, and is read up to byte {at:,}"
