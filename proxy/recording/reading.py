"""Reads recordings, entry by entry, as far as they go. Needs the extra `record`."""

import json
from collections.abc import Generator, Iterator
from dataclasses import replace
from pathlib import Path
from typing import IO, Any, NamedTuple

from mcap.opcode import Opcode
from mcap.records import Channel, Message

from proxy.core.interface.events import Event, SpecsChanged
from proxy.recording.entries import (
    END,
    EVENT_TYPES,
    EVENTS,
    FORMAT,
    GAP,
    PAYLOADS,
    PROFILE,
    SNAPSHOT,
    SPECS,
    START,
    TRAFFIC,
    End,
    Entry,
    Gap,
    Happened,
    Payload,
    Snapshot,
    SpecsText,
    Start,
    Traffic,
)
from proxy.recording.errors import RecordingError
from proxy.recording.json_data import read, reading
from proxy.recording.mcap_reading import DAMAGED, in_chunk, is_mcap, profile_of, records
from utility_specs import Specs

_ENTRIES: dict[str, Any] = {SPECS: SpecsText, TRAFFIC: Traffic, GAP: Gap, END: End}


class Raw(NamedTuple):
    """A message of the file: where it belongs, the number of its event, and its data."""

    topic: str
    key: str
    number: int
    data: bytes


class RecordingReader:
    """Reads one file. Raises RecordingError at once where it is no recording, or cannot be read at all.

    Iterating over it gives the entries in their order; it holds one chunk in memory. What of the file cannot be read
    is left out and told in `problems` while reading. Each pass begins anew.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.problems: list[str] = []
        """What was wrong with the file, as far as it was read: sentences for people."""
        entries = self._entries()
        first = next(entries, None)
        entries.close()
        if not isinstance(first, Start):
            problem = f": {self.problems[0]}" if self.problems else ""
            raise RecordingError(f"{path} has no beginning of a recording of Sendworthy{problem}")
        self.start: Start = first
        """What the file begins with."""

    def __iter__(self) -> Iterator[Entry]:
        return self._entries()

    def _entries(self) -> Generator[Entry]:
        self.problems.clear()
        ended, number = False, -1
        for raw in self._messages():
            try:
                entry = _entry(raw)
            except (RecordingError, ValueError, RecursionError) as error:
                self.problems.append(f"{self.path}: a message on {raw.topic} is unreadable: {error}")
                continue
            if entry is None:
                continue
            if isinstance(entry, Start | Happened | Gap):
                number = self._follow(entry, number)
            ended = isinstance(entry, End)
            yield entry
        if not ended and not self.problems:
            self.problems.append(f"{self.path} was not closed: its last events may be missing")

    def _follow(self, entry: Start | Happened | Gap, due: int) -> int:
        """Note what is missing before an entry, of whose number another one was due; return the next number."""
        if isinstance(entry, Start):
            return entry.number
        first = entry.first if isinstance(entry, Gap) else entry.number
        lacking = (first - due) & 0xFFFFFFFF
        if due >= 0 and 0 < lacking < 1 << 31:
            self.problems.append(f"{self.path}: {lacking} events are missing before event {first}")
        return first + entry.events if isinstance(entry, Gap) else first + 1

    def _messages(self) -> Iterator[Raw]:
        """Yield the messages of the file in their order, and note what is wrong with it."""
        try:
            with self.path.open("rb") as file:
                self._check(file)
                channels: dict[int, Channel] = {}
                for opcode, data in records(self.path, file, self.problems):
                    if opcode == Opcode.CHUNK:
                        yield from self._unpacked(data, channels)
                    elif opcode == Opcode.HEADER:
                        self._check_header(data)
        except OSError as error:
            raise RecordingError(f"{self.path} cannot be read: {error.strerror or error}") from None

    def _check(self, file: IO[bytes]) -> None:
        """Raise RecordingError for what is no MCAP file."""
        if is_mcap(file):
            return
        if not file.tell():
            raise RecordingError(f"{self.path} is empty")
        raise RecordingError(f"{self.path} is no MCAP file; `sendworthy import` reads ROS 2 bags and CSV files")

    def _check_header(self, data: bytes) -> None:
        profile = profile_of(data)
        if profile != PROFILE:
            other = f' but of "{profile}"' if profile else ""
            raise RecordingError(
                f"{self.path} is no recording of Sendworthy{other}; `sendworthy import` makes one of a ROS 2 bag"
            )

    def _unpacked(self, data: bytes, channels: dict[int, Channel]) -> Iterator[Raw]:
        """Yield the messages of a chunk, and note its channels; a damaged chunk is left out."""
        try:
            for record in in_chunk(data):
                if isinstance(record, Channel):
                    channels[record.id] = record
                elif isinstance(record, Message) and record.channel_id in channels:
                    channel = channels[record.channel_id]
                    yield Raw(channel.topic, channel.metadata.get("key", ""), record.sequence, record.data)
        except DAMAGED as error:
            self.problems.append(f"{self.path}: a chunk is damaged and left out: {error}")


def _entry(raw: Raw) -> Entry | None:
    """Return what a message says; None where only a later version knows. Raises RecordingError or ValueError."""
    if raw.topic.startswith(PAYLOADS):
        return Payload(raw.number, raw.key, raw.data)
    name = raw.topic.removeprefix(EVENTS)
    if name is not raw.topic:
        return _happened(raw, name)
    if raw.topic == START:
        return _start(raw)
    if raw.topic == SNAPSHOT:
        return _snapshot(raw)
    kind = _ENTRIES.get(raw.topic)
    return None if kind is None else read(kind, json.loads(raw.data))


def _start(raw: Raw) -> Start:
    data = json.loads(raw.data)
    written = data.get("format") if isinstance(data, dict) else None
    if written != FORMAT:
        raise RecordingError(f"it is of format {written!r:.20}, and only {FORMAT} is understood here")
    start: Start = read(Start, data)
    return start


def _snapshot(raw: Raw) -> Snapshot:
    head, _, data = raw.data.partition(b"\n")
    fields = json.loads(head)
    snapshot: Snapshot = read(Snapshot, fields | {"data": ""} if isinstance(fields, dict) else fields)
    return replace(snapshot, data=data)


def _happened(raw: Raw, name: str) -> Happened:
    kind = EVENT_TYPES.get(name)
    if kind is None:
        raise RecordingError("there is no such event")
    data = json.loads(raw.data)
    if kind is SpecsChanged and isinstance(data, dict):
        event: Event = SpecsChanged(read(float, data.get("now")), Specs((), (), read(str, data.get("specs"))))
    else:
        event = reading(kind)(data)
    return Happened(raw.number, event, tuple(data.get("commands", ())), data.get("fault", ""))
