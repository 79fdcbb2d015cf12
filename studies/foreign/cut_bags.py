"""What can be read of ROS 2 bags without their end: whoever records and is killed leaves no index, or half a file.

rosbags refuses them. Here MCAP is read record by record, and sqlite3 row by row, as far as that goes.
"""

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import IO, Any, NamedTuple
from urllib.parse import quote

from mcap.opcode import Opcode
from mcap.records import Channel, McapRecord, Message, Schema

from proxy.recording.mcap_reading import DAMAGED, in_chunk, is_mcap, profile_of, records, stream

PROFILE = "ros2"
"""What the header of a bag says."""


class Topic(NamedTuple):
    """A topic as rosbags has it."""

    id: int
    topic: str
    msgtype: str
    digest: str = ""


Read = tuple[Topic, int, bytes]
"""A message: its topic, when it was recorded [ns], and itself."""


def files_of(path: Path) -> list[Path]:
    """Return the files of a bag, in their order: itself, or those in the folder."""
    inside = (each for each in path.iterdir() if each.suffix in _READERS) if path.is_dir() else iter((path,))
    return sorted(inside, key=lambda each: (len(each.name), each.name))


@dataclass(slots=True)
class CutFile:
    """A file of a bag that may lack its end."""

    path: Path
    count: int = 0
    """Messages that were read."""
    last: int = 0
    """When the last of these was recorded [ns]."""
    lacks: str = ""
    """What of the file could not be read; empty: nothing."""
    _types: dict[int, str] = field(default_factory=dict)
    _topics: dict[int, Topic] = field(default_factory=dict)

    def messages(self) -> Iterator[Read]:
        """Yield the messages as they stand there. Raises OSError."""
        for read in _READERS[self.path.suffix](self) if self.path.suffix in _READERS else ():
            self.count, self.last = self.count + 1, max(self.last, read[1])
            yield read

    @property
    def problem(self) -> str:
        """What is to be told of what is missing; empty where nothing is."""
        if not self.lacks:
            return ""
        what = f"{self.count:,} messages could be read" if self.count else "no message could be read"
        until = f", up to {datetime.fromtimestamp(self.last / 1e9, UTC):%F %T} UTC" if self.count else ""
        return f"{self.path} {self.lacks}: {what}{until}; what else was recorded is missing"

    def mcap(self) -> Iterator[Read]:
        """Yield the messages of an MCAP file."""
        with self.path.open("rb") as file:
            if is_mcap(file):
                yield from self._records(file)

    def _records(self, file: IO[bytes]) -> Iterator[Read]:
        problems, damaged, good = list[str](), 0, 0
        for opcode, data in records(self.path, file, problems):
            try:
                if opcode == Opcode.HEADER and profile_of(data) != PROFILE:
                    return
                inside = in_chunk(data) if opcode == Opcode.CHUNK else _record(opcode, data)
                read = [found for each in inside if (found := self._take(each)) is not None]
            except DAMAGED:
                damaged += 1
                continue
            yield from sorted(read, key=lambda each: each[1])
            good = file.tell()
        size = self.path.stat().st_size
        if problems or good == size:
            self.lacks = f"was cut off or damaged after byte {good:,} of {size:,}"
        if damaged:
            self.lacks = f"{self.lacks} and " * bool(self.lacks) + f"has {damaged} damaged parts"

    def _take(self, record: McapRecord) -> Read | None:
        """Note what a record tells of topics; return the message that it is."""
        if isinstance(record, Schema):
            self._types[record.id] = record.name
        elif isinstance(record, Channel):
            self._topics[record.id] = Topic(record.id, record.topic, self._types.get(record.schema_id, ""))
        elif isinstance(record, Message) and record.channel_id in self._topics:
            return self._topics[record.channel_id], record.log_time, record.data
        return None

    def database(self) -> Iterator[Read]:
        """Yield the messages of a database."""
        with closing(sqlite3.connect(f"file:{quote(str(self.path))}?immutable=1", uri=True)) as database:
            try:
                yield from self._rows(database)
            except sqlite3.DatabaseError as error:
                size, whole = self.path.stat().st_size, _pages(self.path)
                self.lacks = f"has {size:,} of {whole:,} bytes" if whole > size else f"is damaged ({error})"

    def _rows(self, database: sqlite3.Connection) -> Iterator[Read]:
        database.execute("PRAGMA writable_schema = ON")  # else SQLite opens none that has fewer pages than it says
        columns = [row[1] for row in database.execute("PRAGMA table_info(topics)")]
        for row in database.execute("SELECT * FROM topics"):
            told: dict[str, Any] = dict(zip(columns, row, strict=True))
            digest = str(told.get("type_description_hash") or "")
            self._topics[told["id"]] = Topic(told["id"], str(told["name"]), str(told["type"]), digest)
        for topic, at, data in database.execute("SELECT topic_id, timestamp, data FROM messages"):
            if topic not in self._topics:  # in half a page
                raise sqlite3.DatabaseError("a row is damaged")
            yield self._topics[topic], at, data


def _pages(path: Path) -> int:
    """Return how many bytes a database says that it has, 0 if nothing: the size of a page times the number of these."""
    with path.open("rb") as file:
        head = file.read(32)
    return int.from_bytes(head[16:18]) * int.from_bytes(head[28:32])


def _record(opcode: int, data: bytes) -> list[McapRecord]:
    """Return what stands in no chunk."""
    match opcode:
        case Opcode.SCHEMA:
            return [Schema.read(stream(data))]
        case Opcode.CHANNEL:
            return [Channel.read(stream(data))]
        case Opcode.MESSAGE:
            return [Message.read(stream(data), len(data))]
    return []


_READERS = {".mcap": CutFile.mcap, ".db3": CutFile.database}
