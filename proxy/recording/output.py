"""Writes what a daemon records, into one file after the other. Where nothing can be written it counts what is missing.

Only the recorder's thread is in here. Needs the extra `record`.
"""

import logging
import os
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

from proxy import clock
from proxy.bridge.payloads import Content
from proxy.core.interface.events import ClockChanged, Event, SamplePublished, SpecsChanged
from proxy.heap import give_back
from proxy.recording.entries import Payload, Snapshot, SpecFile, SpecsText, Start
from proxy.recording.folder import RecordingFolder
from proxy.recording.missing import Missing
from proxy.recording.tuning import TUNING
from proxy.recording.writing import RecordingWriter
from utility_specs import Specs

log = logging.getLogger(__name__)


Taken = tuple[int, Event, Sequence[Any], str, Content | None]
"""An event that the core took in: its number, itself, the commands that followed, the fault, the payload."""


_SPECIAL = frozenset((SpecsChanged, ClockChanged))
"""Events with which more begins than a line."""


@dataclass(frozen=True, slots=True)
class Written:
    """What was recorded so far."""

    file: str = ""
    files: int = 0
    bytes: int = 0
    """Of all files."""
    missing: int = 0
    problem: str = ""
    """Why nothing is recorded at the moment."""

    def lacking(self, events: int) -> "Written":
        """Return the same with so many events missing more."""
        return replace(self, missing=self.missing + events)


@dataclass(frozen=True, slots=True)
class Head:
    """What the core knows at this place, where another file may begin; None where that cannot be told."""

    snapshot: Snapshot | None


class Output:
    """Writes items in their order. `start` is what a file begins with, but for its first number."""

    def __init__(self, start: Start, specs: Specs, folder: RecordingFolder, file_bytes: int) -> None:
        self._start = start
        self._specs = specs
        self._folder = folder
        self._file_bytes = file_bytes
        self._full_at = file_bytes - min(TUNING.reserve, file_bytes // 2)
        self._writer: RecordingWriter | None = None
        self._number = start.number
        self._now = start.now
        self._in_hand = Missing()
        """What is in the writer, but in no file yet: missing, should it not come there."""
        self._last = Missing()
        """What is in the chunk that was written last."""
        self._missing = Missing()
        self._retry_at = 0.0
        self._retry = TUNING.retry
        self._closed_bytes = 0
        self.heads = 0 if start.whole else 1
        """So many `Head`s it has asked for: where a file is as large as it may be, or begins in mid-life."""
        self._heads_come = 0
        """Of so many it waits no longer."""
        self.written = Written()

    def open(self) -> None:
        """Open the first file."""
        self._try(self._begin)

    @property
    def stuck(self) -> bool:
        """Whether there is no file, or what is missing is not noted in it yet."""
        return self._writer is None or bool(self._missing)

    def add(self, item: Taken | Missing | Head) -> None:
        """Take in what comes next."""
        if isinstance(item, Missing):
            self._lacks(item)
            return
        if isinstance(item, Head):
            self._head(item)
            return
        number, event, commands, fault, payload = item
        writer = self._writer
        self._number, self._now = number + 1, event.now
        if type(event) is ClockChanged:
            self._folder.set_clock(event.wall_offset - self._start.wall_offset)
            self._start = replace(self._start, wall_offset=event.wall_offset)
        if writer is None or self._missing:
            self._specs = event.specs if isinstance(event, SpecsChanged) else self._specs
            self._missing.event(number, event)
            if payload is not None:
                self._missing.payload()
            self.written = self.written.lacking(1)
            return
        self._in_hand.event(number, event)
        if payload is not None or type(event) is SpecsChanged:
            self._precede(writer, event, payload)
        writer.happened(event, commands, fault)
        if writer.pending >= TUNING.chunk:
            self.flush()

    def add_all(self, items: Sequence[Taken | Missing | Head]) -> None:
        """Take in what comes next: as `add` of each, which takes twice the time."""
        if not self._add_plain(items):
            for each in items:
                self.add(each)

    def _add_plain(self, items: Sequence[Any]) -> bool:
        """Take in events that have nothing written before them, and made no fault; whether all are such."""
        writer = self._writer
        if writer is None or self._missing or set(map(type, items)) != {tuple}:
            return False
        numbers, events, followed, faults, payloads = zip(*items, strict=True)
        if any(faults) or payloads.count(None) < len(items) or not _SPECIAL.isdisjoint(map(type, events)):
            return False
        self._in_hand.all_events(numbers[0], events)
        self._number, self._now = numbers[-1] + 1, events[-1].now
        writer.all_happened(events, followed)
        if writer.pending >= TUNING.chunk:
            self.flush()
        return True

    def flush(self) -> None:
        """Bring to the file what is in hand, and say there what is missing; ask for a head where it is full.

        A file that somebody has deleted is followed by another one: nobody would find it, and it would take room still.
        """
        if self._writer is not None and self._writer.file.deleted:
            log.warning("recording: %s was deleted; another file begins", self.written.file)
            self._end("deleted")
            self._missing.follow(self._in_hand, "their file was deleted")
            self.written, self._in_hand = self.written.lacking(self._in_hand.events), Missing()
            self._retry_at = 0.0
        if self._missing or self._writer is None:
            self._recover()
        elif self._try(self._writer.flush):
            self._settle()
        if self._writer is None:
            return
        self.written = replace(self.written, bytes=self._closed_bytes + self._writer.size)
        if self._full and not self._missing:
            self.heads = self._heads_come + 1

    def close(self, reason: str) -> None:
        """Write all that is in hand, and close the file. On a full disk the last chunk makes room to say so."""
        self._retry_at = 0.0
        self.flush()
        if self._writer is not None:
            if self._missing and self._writer.take_back():
                self._last.follow(self._missing, self._missing.reason)
                self._writer.gap(self._last.gap(self._number), self._now)
            self._end(reason)

    def give_up(self, reason: str, number: int) -> None:
        """An error ended all: the file stays as it is, what is in no file up to event `number` is missing."""
        lost = number - self._number + self._in_hand.events
        self.written = replace(self.written.lacking(lost), problem=reason)
        if self._writer is not None:
            self._writer.abandon()

    def _head(self, head: Head) -> None:
        """Begin another file here if this one is full; write what the core knows."""
        if self._full:
            self.flush()
        self._heads_come = self.heads
        if self._missing:
            return
        if self._full:
            self._end("rotated")
            self._try(self._begin)
        if self._writer is not None and head.snapshot is not None:
            self._writer.snapshot(head.snapshot)
            if self._try(self._writer.flush):
                self._settle()
            give_back()  # what the snapshot took: else a daemon keeps that, 2 MB of 200 streams

    @property
    def _full(self) -> bool:
        """Whether another file is to begin, also as the wall clock was set, by which all times in a file are."""
        writer = self._writer
        return writer is not None and (
            writer.size >= self._full_at
            or len(writer.channels) >= TUNING.channels
            or abs(self._start.wall_offset - writer.offset) > TUNING.step
        )

    def _end(self, reason: str) -> None:
        """Close the file; where there is no room for its end it does without."""
        if self._writer is not None:
            with suppress(OSError):
                self._writer.close(reason, self._now)
            self._closed_bytes += self._writer.size
            self.written = replace(self.written, bytes=self._closed_bytes)
            self._writer = None

    def _begin(self) -> None:
        """Open the next file. Raises OSError."""
        whole = self._number == self._start.number and self._start.whole
        start = replace(self._start, number=self._number, whole=whole, generation=self._specs.generation)
        start = start if whole else replace(start, now=self._now)
        path = self._folder.next(self._file_bytes)
        writer = RecordingWriter(path, start)
        try:
            writer.specs(text_of(self._specs), self._now)
            writer.flush()
        except OSError:
            writer.abandon()
            path.unlink(missing_ok=True)  # nothing is in there
            raise
        self._writer = writer
        self.written = replace(self.written, file=str(path), files=self.written.files + 1)

    def _precede(self, writer: RecordingWriter, event: Event, payload: Content | None) -> None:
        """Write what stands before an event: its specs, its payload."""
        if isinstance(event, SpecsChanged):
            self._specs = event.specs
            writer.specs(text_of(event.specs), self._now)
        if payload is not None and isinstance(event, SamplePublished):
            self._in_hand.payload()
            data, encoding = payload.read()
            writer.payload(Payload(event.sample, event.key, data), encoding, self._now)

    def _lacks(self, other: Missing) -> None:
        """Note that what comes next is missing."""
        self._number += other.events
        self.written = self.written.lacking(other.events)
        if self._missing or self._writer is None:
            self._missing.follow(other)
            return
        self._in_hand.follow(other)
        self._writer.gap(other.gap(self._number), self._now)

    def _try(self, write: Callable[[], object]) -> bool:
        """Write; whether that went well. If not, all that was in hand is missing."""
        try:
            write()
        except OSError as error:
            self._fail(error)
            return False
        return True

    def _fail(self, error: OSError) -> None:
        reason = os.strerror(error.errno) if error.errno else str(error)
        reason = f"{error.filename}: {reason}" if error.filename else reason
        if self.written.problem != reason:
            log.error("recording: %s; the record says what is missing", reason)
        self.written = replace(self.written.lacking(self._in_hand.events), problem=reason)
        self._missing.follow(self._in_hand, reason)
        self._in_hand = Missing()
        self._retry_at = clock.monotonic() + self._retry
        self._retry = min(2.0 * self._retry, TUNING.longest_retry)

    def _recover(self) -> None:
        """Try again to write, first of all what is missing."""
        if clock.monotonic() >= self._retry_at and self._try(self._go_on):
            self._last, self._missing = self._missing, Missing()

    def _go_on(self) -> None:
        if self._writer is None:
            self._begin()
            self.heads = self._heads_come + 1
        if self._writer is not None:
            if self._missing:
                self._writer.gap(self._missing.gap(self._number), self._now)
            self._writer.flush()

    def _settle(self) -> None:
        """What was in hand is in the file."""
        if not self._in_hand:
            return
        self._last, self._in_hand = self._in_hand, Missing()
        if self.written.problem:
            log.warning("recording goes on; %d events are missing so far", self.written.missing)
            self.written, self._retry = replace(self.written, problem=""), TUNING.retry


def text_of(specs: Specs) -> SpecsText:
    """Return specs as they were written."""
    return SpecsText(specs.generation, tuple(SpecFile(name, text) for name, text in specs.texts))
