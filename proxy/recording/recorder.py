"""Records what the core takes in and what it decides: noted by who uses the core, written on another thread."""

import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

from proxy import clock
from proxy.bridge.payloads import Content
from proxy.core.interface.commands import Command, Decide
from proxy.core.interface.events import Event, SamplePublished, Taker
from proxy.recording.entries import Snapshot
from proxy.recording.errors import RecordingError
from proxy.recording.missing import Missing
from proxy.recording.output import Head, Output, Taken
from proxy.recording.tuning import TUNING
from proxy.recording.writing import described

log = logging.getLogger(__name__)

Look = Callable[[int, float], Snapshot]
"""Returns what the core knows before the event with a number, at a time [s]; raises RecordingError."""
FULL = "more than could be written"
_MANY = TUNING.many


class Recorder:
    """Notes each event that it hands to a core, from number `first` on; `output` writes them.

    `look` takes a snapshot of the core, where one is due. `payload` finds the payload of a sample by its number; None:
    payloads are not recorded.
    """

    def __init__(
        self,
        core: Taker,
        output: Output,
        look: Look,
        first: int = 0,
        payload: Callable[[int], Content | None] | None = None,
    ) -> None:
        self._core = core
        self._output = output
        self._look = look
        self._number = self._first = first
        self._payload = payload
        self.unsaved = ""
        """Why there is no snapshot of the core, where one is due."""
        self._heads = 0
        """So many heads were given to the output."""
        self._items: deque[Taken | Missing | Head] = deque()
        self._writing = 0
        """So many of them are being written."""
        self._missing: Missing | None = None
        self._special = True
        """Whether samples that are only passed on are looked at before they are noted."""
        self._held = self._given = 0
        """Bytes of payloads that were noted, and that were written or given up [B]."""
        self._wake = threading.Event()
        self._open = True
        self._lost_from: int | None = None
        """The number from which on nothing is noted, as an error ended the writing."""
        self._begun = threading.Event()
        self._thread = threading.Thread(target=self._run, name="recorder", daemon=True)

    def start(self) -> None:
        """Start writing."""
        self._thread.start()

    def stop(self) -> None:
        """Write all that was noted, and close the file: soon."""
        self._open = False
        self._wake.set()

    def begun(self, timeout: float) -> bool:
        """Wait at most `timeout` [s] until there is a file, or a reason why there is none; whether that is so."""
        return self._begun.wait(timeout)

    def wait(self, timeout: float) -> bool:
        """Wait at most `timeout` [s] for that; whether it is done."""
        self._thread.join(timeout)
        return not self._thread.is_alive()

    @property
    def waiting(self) -> int:
        """Events that wait to be written, or are being written."""
        return len(self._items) + self._writing

    def describe(self) -> dict[str, object]:
        """Return what the status says of it."""
        written, number, from_ = self._output.written, self._number, self._lost_from
        waiting = self._missing.events if self._missing else 0
        return {
            "file": written.file,
            "files": written.files,
            "bytes": written.bytes,
            "events": number - self._first,
            "missing": written.missing + (waiting if from_ is None else number - from_),
            "problem": written.problem or self.unsaved,
        }

    def handle(self, event: Event) -> list[Command]:
        """Have the core take in an event, and note it with what follows. By who uses the core."""
        if self._output.heads > self._heads:
            self._save(event.now)
        try:
            commands = self._core.handle(event)
        except Exception as error:
            self._note(event, (), f"{type(error).__name__}: {error}")
            raise
        told: Sequence[Any] = commands
        for each in commands:
            if type(each) is Decide:  # its problem is large, and nothing of it is recorded: it must not wait here
                told = [described(each) if type(each) is Decide else each for each in commands]
                break
        self._note(event, told, "")
        return commands

    def pass_on(self, event: Event) -> list[Command] | None:
        """Have the core only pass a sample on, and note that; None where it does not, or a snapshot is due first."""
        if self._special:
            return self._pass_on(event)
        commands = self._core.pass_on(event)
        if commands is not None:  # as `_note`, in few steps
            number = self._number
            self._number = number + 1
            self._items.append((number, event, commands, "", None))
            if len(self._items) >= _MANY:
                self._special = True
        return commands

    def _pass_on(self, event: Event) -> list[Command] | None:
        """Do that where there is more to it than to note the event."""
        if self._output.heads > self._heads:
            return None
        commands = self._core.pass_on(event)
        if commands is not None:
            self._note(event, commands, "")
            special = self._payload is not None or self._missing is not None or self._lost_from is not None
            self._special = special or len(self._items) >= _MANY
        return commands

    def _save(self, now: float) -> None:
        """Note what the core knows now."""
        self._heads, snapshot = self._output.heads, None
        try:
            snapshot, unsaved = self._look(self._number, now), ""
        except RecordingError as error:
            unsaved = f"it cannot be replayed exactly, for there is no snapshot of the core: {error}"
            if unsaved != self.unsaved:
                log.warning("recording: %s", unsaved)
        self.unsaved = unsaved
        if self._missing is not None:
            self._items.append(self._missing)
            self._missing = None
        self._items.append(Head(snapshot))

    def _note(self, event: Event, commands: Sequence[Any], fault: str) -> None:
        number, items = self._number, self._items
        self._number = number + 1
        if self._lost_from is not None:
            return
        if len(items) >= TUNING.events:
            self._missing = self._missing or Missing(FULL)
            self._missing.event(number, event)
            return
        if self._missing is not None:
            items.append(self._missing)
            self._missing = None
        payload = None if self._payload is None else self._payload_of(event)
        items.append((number, event, commands, fault, payload))
        if len(items) >= _MANY or (payload is not None and self._held - self._given >= TUNING.chunk):
            self._wake.set()

    def _payload_of(self, event: Event) -> Content | None:
        if self._payload is None or not isinstance(event, SamplePublished) or event.delete:
            return None
        found = self._payload(event.sample)
        if found is None:
            return None
        if self._held - self._given + found.size > TUNING.payload_bytes:
            missing = Missing(FULL)
            missing.payload()
            self._items.append(missing)
            return None
        self._held += found.size
        return found

    def _run(self) -> None:
        try:
            self._record()
        except Exception as error:
            log.exception("recording ends, for an error")
            self._give_up(f"{type(error).__name__}: {error}")

    def _give_up(self, reason: str) -> None:
        """Nothing is written any more, so nothing waits."""
        number = self._number
        self._output.give_up(reason, number)
        self._lost_from, self._special, self._heads = number, True, self._output.heads
        self._items.clear()
        self._writing = 0
        self._begun.set()

    def _record(self) -> None:
        self._output.open()
        self._begun.set()
        flushed = clock.monotonic()
        while True:
            closing = not self._open
            self._wake.clear()
            self._write()
            now = clock.monotonic()
            if now >= flushed + TUNING.flush:
                self._output.flush()
                flushed = now
                if self._output.heads > self._heads:
                    self._special = True
            if closing:
                break
            self._wake.wait(flushed + TUNING.flush - now)
        if self._missing is not None:
            self._output.add(self._missing)
        self._output.close("stopped")

    def _write(self) -> None:
        """Write what waits, slice by slice."""
        while self._items:
            self._writing = min(len(self._items), TUNING.slice)
            items = [self._items.popleft() for _ in range(self._writing)]
            self._output.add_all(items)
            if self._payload is not None:
                self._given += sum([item[4].size for item in items if type(item) is tuple and item[4] is not None])
            self._writing = 0
            time.sleep(TUNING.pause)
