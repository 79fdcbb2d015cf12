"""Writes entries as messages of an MCAP file. Needs the extra `record`."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Self

from proxy.core.interface.commands import Command, Decide
from proxy.core.interface.events import Event
from proxy.recording.entries import (
    END,
    EVENTS,
    GAP,
    PAYLOADS,
    PROFILE,
    SNAPSHOT,
    SPECS,
    START,
    TRAFFIC,
    End,
    Gap,
    Payload,
    Snapshot,
    SpecsText,
    Start,
    Traffic,
)
from proxy.recording.json_data import plain, schema, text
from proxy.recording.mcap_file import McapFile
from proxy.recording.quick_json import line, lines
from proxy.recording.tuning import TUNING

_KINDS: Mapping[str, type] = {START: Start, SPECS: SpecsText, TRAFFIC: Traffic, GAP: Gap, END: End}
_EXTRA: dict[str, dict[str, Any]] = {
    "commands": {"type": "array", "items": {"type": "object", "properties": {"command": {"type": "string"}}}},
    "fault": {"type": "string"},
}


class RecordingWriter:
    """Writes a recording that begins with `start`; raises FileExistsError, or OSError, as all that it does may.

    What is written comes to the file with `flush`, which makes a chunk of it, and `close`; traffic chunk by chunk.
    """

    def __init__(self, path: Path, start: Start) -> None:
        self.file = McapFile(path, PROFILE, f"sendworthy {start.version}".rstrip())
        self.offset = start.wall_offset
        """What the wall clock shows more than the clock of its times [s]."""
        self.channels: dict[str, int] = {}
        """The channel of each kind of entry, and of each key of payloads."""
        self._events: dict[type[Event], int] = {}
        self.number = start.number
        """That of the next event."""
        self._entry(START, start, start.now)

    @property
    def size(self) -> int:
        """Bytes of the file so far, those in hand included."""
        return self.file.size

    @property
    def pending(self) -> int:
        """Bytes in hand, not compressed."""
        return self.file.pending

    def specs(self, specs: SpecsText, now: float = 0.0) -> None:
        """Write specs, before the first event under them."""
        self._entry(SPECS, specs, now)

    def snapshot(self, snapshot: Snapshot) -> None:
        """Write what the core knew before the next event: a line of JSON, and behind it the data."""
        head = plain(snapshot)
        data = head.pop("data")
        channel = self.channels.get(SNAPSHOT)
        if channel is None:
            channel = self.channels[SNAPSHOT] = self.file.channel(SNAPSHOT, "application/octet-stream", None, {})
        self._add(channel, snapshot.now, text(head).encode() + b"\n" + data)

    def happened(self, event: Event, commands: Sequence[Command | dict[str, Any]] = (), fault: str = "") -> None:
        """Write the next event, and the commands that followed, as such or `described`, or the fault that it made."""
        data = None if fault else line(event, commands)
        if data is None:
            data = text(_told(event, commands, fault)).encode()
        kind, number = type(event), self.number
        at = self._nanoseconds(event.now)
        self.file.add(self._events.get(kind) or self._event_channel(kind), number, at, at, data)
        self.number = number + 1

    def all_happened(self, events: Sequence[Event], followed: Sequence[Sequence[Command | dict[str, Any]]]) -> None:
        """Write the next events, and the commands that followed each: as `happened`, in half the time."""
        found = lines(events, followed)
        if found is None:
            for event, commands in zip(events, followed, strict=True):
                self.happened(event, commands)
            return
        channels = [self._events.get(type(event)) or self._event_channel(type(event)) for event in events]
        offset = self.offset
        times = [max(0, int((event.now + offset) * 1e9)) for event in events]
        self.file.add_all(channels, self.number, times, found)
        self.number += len(events)

    def traffic(self, traffic: Traffic) -> None:
        """Write a sample of a recording of mere traffic."""
        self._entry(TRAFFIC, traffic, traffic.t_gen)
        if self.pending >= TUNING.chunk:
            self.flush()

    def payload(self, payload: Payload, encoding: str, now: float) -> None:
        """Write a payload as it was, on a channel of its key; `encoding` is what Zenoh says of it."""
        topic = PAYLOADS + payload.key
        channel = self.channels.get(topic)
        if channel is None:
            json_text = encoding in ("application/json", "text/json")
            told = {"key": payload.key, "encoding": encoding}
            channel = self.file.channel(topic, "json" if json_text else "application/octet-stream", None, told)
            self.channels[topic] = channel
        at = self._nanoseconds(now)
        self.file.add(channel, payload.sample, at, at, payload.data)

    def gap(self, gap: Gap, now: float) -> None:
        """Say what is missing; the next event is the one after it. Before the first one it says so in `first`."""
        self._entry(GAP, gap, now)
        self.number = gap.first + gap.events

    def flush(self) -> None:
        """Bring to the file what is in hand."""
        self.file.flush()

    def take_back(self) -> bool:
        """Give up the chunk that was written last, so that there is room for a word; whether there was one."""
        return self.file.take_back()

    def close(self, reason: str, now: float = 0.0) -> None:
        """Write what is in hand, that the file ends here, and its summary."""
        self._entry(END, End(self.number, reason), now)
        self.file.close()

    def abandon(self) -> None:
        """Close the file as it is."""
        self.file.abandon()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            self.close("done")
        else:
            self.abandon()

    def _entry(self, topic: str, entry: Any, now: float) -> None:
        channel = self.channels.get(topic)
        if channel is None:
            channel = self.file.channel(topic, "json", _schema(_KINDS[topic], {}), {})
            self.channels[topic] = channel
        self._add(channel, now, text(plain(entry)).encode())

    def _event_channel(self, kind: type[Event]) -> int:
        channel = self.file.channel(EVENTS + kind.__name__, "json", _schema(kind, _EXTRA), {})
        self._events[kind] = channel
        return channel

    def _add(self, channel: int, now: float, data: bytes) -> None:
        at = self._nanoseconds(now)
        self.file.add(channel, self.number, at, at, data)

    def _nanoseconds(self, now: float) -> int:
        """Return the wall time of a time in the recording [ns]."""
        return max(0, int((now + self.offset) * 1e9))


def _told(event: Event, commands: Sequence[Command | dict[str, Any]], fault: str) -> dict[str, Any]:
    data = plain(event)
    if commands:
        data["commands"] = [each if isinstance(each, dict) else described(each) for each in commands]
    if fault:
        data["fault"] = fault
    return data


def described(command: Command) -> dict[str, Any]:
    """Return a command as plain data; a problem is told by how many messages it is about."""
    data = {"command": type(command).__name__} | plain(command)
    if isinstance(command, Decide):
        del data["problem"]
        data["messages"] = len(command.problem.messages)
    return data


def _schema(kind: type, extra: dict[str, Any]) -> tuple[str, bytes]:
    return f"sendworthy.{kind.__name__}", json.dumps(schema(kind, **extra)).encode()
