"""An MCAP file that is written as it goes: chunks of messages, each of which can be read once it is there.

Behind the last chunk there always is an end without a summary, which the next chunk overwrites: so readers that begin
with the end read the file also while it is written, when whoever writes it was killed, and when the disk is full.

Messages are packed here, for a daemon records some thousand a second, and the library takes ten times as long for
each; all other records are the library's. So this module needs the extra `record`.
"""

import os
import struct
import zlib
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Self

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Schema,
    Statistics,
    SummaryOffset,
)

MAGIC = b"\x89MCAP0\r\n"
"""What files begin and end with. The library has it where it writes files itself, which loads 1.3 MB besides."""
_MESSAGE = struct.Struct("<BQHIQQ")
_INDEX = struct.Struct("<BQHI")
_CHUNK = struct.Struct("<BQQQQI")
_FIXED = 22
"""Bytes of a message before its data..."""
_HEAD = _MESSAGE.size - _FIXED
"""... and those before them, which are not counted in its length."""
_OPCODE = int(Opcode.MESSAGE)


def _packed(record: McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return bytes(builder.end())  # type: ignore[no-untyped-call]


END = _packed(DataEnd(0)) + _packed(Footer(0, 0, 0)) + MAGIC
"""What a file without a summary ends with."""


class McapFile:
    """Messages on channels. Every method that writes raises OSError; what was written before stays readable.

    A channel is made with the first message on it, and stands before that. `library` says who wrote the file.
    """

    def __init__(self, path: Path, profile: str, library: str) -> None:
        self._file = path.open("xb", buffering=0)
        self._size = 0
        """Where the next record goes."""
        self._left = len(END)
        """Bytes of the end behind that."""
        self._pending = bytearray()
        self._fresh = bytearray()
        """Schemas that no chunk has yet."""
        self._places: defaultdict[int, list[int]] = defaultdict(list)
        self._begin = self._end = 0
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._chunks: list[tuple[ChunkIndex, dict[int, int], bytes]] = []
        """Each with how many messages it has of which channel, and its schemas."""
        self._compressor = zstandard.ZstdCompressor(level=1)
        try:
            self._put(MAGIC + _packed(Header(profile, library)))
        except OSError:
            self._file.close()
            path.unlink(missing_ok=True)
            raise

    @property
    def size(self) -> int:
        """Bytes that the file has, and those that are in hand, before they are compressed."""
        return self._size + self._left + len(self._fresh) + len(self._pending)

    @property
    def deleted(self) -> bool:
        """Whether nobody will find what is written, as somebody has removed the file."""
        return os.fstat(self._file.fileno()).st_nlink == 0

    @property
    def pending(self) -> int:
        """Bytes in hand, which are in no chunk yet."""
        return len(self._pending)

    def channel(self, topic: str, encoding: str, schema: tuple[str, bytes] | None, metadata: Mapping[str, str]) -> int:
        """Add a channel; return its number. `schema` is a name and a JSON schema."""
        number = 0
        if schema is not None:
            number = len(self._schemas) + 1
            self._schemas.append(Schema(id=number, data=schema[1], encoding="jsonschema", name=schema[0]))
            self._fresh += _packed(self._schemas[-1])
        channel = Channel(
            id=len(self._channels) + 1,
            topic=topic,
            message_encoding=encoding,
            metadata=dict(metadata),
            schema_id=number,
        )
        self._channels.append(channel)
        return channel.id

    def add(self, channel: int, number: int, log_time: int, publish_time: int, data: bytes) -> None:
        """Add a message to the chunk in hand. Times are nanoseconds, `number` counts modulo 2³²."""
        places, pending = self._places, self._pending
        if not places:
            self._begin = self._end = log_time
        elif log_time > self._end:
            self._end = log_time
        elif log_time < self._begin:
            self._begin = log_time
        places[channel] += (log_time, len(pending))
        pending += _MESSAGE.pack(_OPCODE, _FIXED + len(data), channel, number & 0xFFFFFFFF, log_time, publish_time)
        pending += data

    def add_all(self, channels: Sequence[int], first: int, times: Sequence[int], data: Sequence[bytes]) -> None:
        """Add messages, numbered from `first` on, as `add` would, each with one time, in a third of its time."""
        places, pack, parts = self._places, _MESSAGE.pack, list[bytes]()
        self._begin = min(self._begin if places else times[0], *times)
        self._end = max(self._end if places else times[0], *times)
        place = len(self._pending)
        for number, (channel, time, each) in enumerate(zip(channels, times, data, strict=True), first):
            places[channel] += (time, place)
            length = _FIXED + len(each)
            parts += (pack(_OPCODE, length, channel, number & 0xFFFFFFFF, time, time), each)
            place += _HEAD + length
        self._pending += b"".join(parts)

    def flush(self) -> None:
        """Write the chunk in hand; where that fails it is lost, but the file stays as it was before."""
        if not self._places:
            return
        places, fresh = dict(self._places), bytes(self._fresh)
        # Each chunk has the channels that it needs: so it can be read though one before it is damaged.
        head = fresh + b"".join(_packed(self._channels[channel - 1]) for channel in places)
        raw = head + self._pending
        self._pending.clear()
        self._places.clear()
        data = self._compressor.compress(raw)
        chunk = _chunk(self._begin, self._end, raw, data)
        index, offsets = bytearray(), dict[int, int]()
        for channel, found in places.items():
            offsets[channel] = self._size + len(chunk) + len(index)
            shift = len(head)
            found[1::2] = [place + shift for place in found[1::2]]
            index += _INDEX.pack(Opcode.MESSAGE_INDEX, 6 + 8 * len(found), channel, 8 * len(found))
            index += struct.pack(f"<{len(found)}Q", *found)
        begin = self._size
        self._put(chunk + index)
        self._fresh.clear()
        record = ChunkIndex(
            chunk_length=len(chunk),
            chunk_start_offset=begin,
            compression="zstd",
            compressed_size=len(data),
            message_end_time=self._end,
            message_index_length=len(index),
            message_index_offsets=offsets,
            message_start_time=self._begin,
            uncompressed_size=len(raw),
        )
        self._chunks.append((record, {channel: len(found) // 2 for channel, found in places.items()}, fresh))

    def take_back(self) -> bool:
        """Forget the chunk that was written last, so that there is room where it stands; whether that can be.

        The first one stays.

        What is lost then is the caller's to note.
        """
        if len(self._chunks) < 2:
            return False
        record, _, schemas = self._chunks.pop()
        self._fresh[:0] = schemas
        self._size = record.chunk_start_offset
        return True

    def close(self) -> None:
        """Write the chunk in hand and the summary; without room for a summary the file ends without."""
        try:
            self.flush()
            with suppress(OSError):
                self._put(_packed(DataEnd(0)) + self._summary(self._size + len(_packed(DataEnd(0)))), b"")
                self._left = 0
        finally:
            with suppress(OSError):
                self._file.truncate(self._size + self._left)  # what a chunk that was taken back had left behind
            self._file.close()

    def abandon(self) -> None:
        """Close the file as it is: it can be read as far as it goes."""
        self._file.close()

    def _put(self, data: bytes | bytearray, end: bytes = END) -> None:
        """Write all of this and an end, or nothing."""
        try:
            self._write(data + end)
        except OSError:
            with suppress(OSError):
                self._write(END)  # there is room, for it was there before
                self._file.truncate()
            raise
        self._size += len(data)

    def _write(self, data: bytes | bytearray) -> None:
        self._file.seek(self._size)
        left = memoryview(data)
        while left:
            left = left[self._file.write(left) :]

    def _summary(self, start: int) -> bytes:
        """Return what stands behind the data: all channels, counts, and where the chunks are."""
        groups: list[tuple[Opcode, list[McapRecord]]] = [
            (Opcode.SCHEMA, [*self._schemas]),
            (Opcode.CHANNEL, [*self._channels]),
            (Opcode.STATISTICS, [self._statistics()]),
            (Opcode.CHUNK_INDEX, [record for record, *_ in self._chunks]),
        ]
        summary, offsets = bytearray(), bytearray()
        for opcode, records in groups:
            begin = len(summary)
            summary += b"".join(map(_packed, records))
            length = len(summary) - begin
            offsets += _packed(SummaryOffset(group_opcode=opcode, group_start=start + begin, group_length=length))
        offset_start = start + len(summary)
        summary += offsets
        footer = struct.pack("<BQQQ", Opcode.FOOTER, 20, start, offset_start)
        crc = zlib.crc32(footer, zlib.crc32(summary))
        return bytes(summary) + _packed(Footer(start, offset_start, crc)) + MAGIC

    def _statistics(self) -> Statistics:
        counts = Counter[int]()
        for _, counted, _ in self._chunks:
            counts.update(counted)
        return Statistics(
            attachment_count=0,
            channel_count=len(self._channels),
            channel_message_counts=counts,
            chunk_count=len(self._chunks),
            message_count=counts.total(),
            metadata_count=0,
            message_start_time=min((record.message_start_time for record, *_ in self._chunks), default=0),
            message_end_time=max((record.message_end_time for record, *_ in self._chunks), default=0),
            schema_count=len(self._schemas),
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _chunk(begin: int, end: int, raw: bytes, data: bytes) -> bytes:
    """Return the record of a chunk."""
    compression = b"zstd"
    length = 8 + 8 + 8 + 4 + 4 + len(compression) + 8 + len(data)
    head = _CHUNK.pack(Opcode.CHUNK, length, begin, end, len(raw), zlib.crc32(raw))
    return head + struct.pack("<I", len(compression)) + compression + struct.pack("<Q", len(data)) + data
