"""What recordings hold, as samples in the order of their times; files are read entry by entry, never whole."""

import heapq
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from proxy.core.interface.events import ClockChanged, DecisionReady, SamplePublished, SamplesPassed
from proxy.recording.entries import Entry, Happened, Payload, SpecsText, Start, Traffic
from proxy.recording.errors import RecordingError
from proxy.recording.reading import RecordingReader
from studies.replay.adaptive import Borne
from studies.replay.errors import ReplayError
from studies.replay.samples import SENT, Fate, Passed, Sample, Told


@dataclass(slots=True)
class Survey:
    """What a first look found: samples of each robot, the time of the first and of the last one [s], and `problems`."""

    samples: Counter[str] = field(default_factory=Counter)
    first: float = float("inf")
    last: float = -float("inf")
    superseded: int = 0
    """Samples that gave way before the core was told of them."""
    specs: SpecsText | None = None
    """Those in force at the beginning."""
    problems: list[str] = field(default_factory=list)
    borne: Borne = field(default_factory=Borne)

    @property
    def seconds(self) -> float:
        """From the first sample to the last [s]."""
        return max(0.0, self.last - self.first)


@dataclass(slots=True)
class _Life:
    """A robot's life: its first and its last sample on its own clock, and what its wall clock showed more last [s]."""

    first: float = float("inf")
    last: float = -float("inf")
    offset: float = 0.0
    _at: float = -float("inf")

    def shown(self, now: float, offset: float) -> None:
        """The wall clock showed so much more at `now`."""
        if now >= self._at:
            self._at, self.offset = now, offset


class Recordings:
    """Some files, read as one recording; `survey` comes first.

    All times of a robot's life are on its wall clock as that was last: one that boots without a clock is right later.
    """

    def __init__(self, files: Sequence[RecordingReader]) -> None:
        self._files = tuple(files)
        self._lives: dict[tuple[str, str], _Life] = {}

    def survey(self) -> Survey:
        """Look at everything once. Raises ReplayError where nothing was published."""
        found = Survey()
        for file in self._files:
            self._look(found, file)
            found.problems += file.problems
        if not found.samples:
            raise ReplayError(f"{', '.join(str(file.path) for file in self._files)}: no sample was published in it")
        found.first = min(life.first + life.offset for life in self._lives.values())
        found.last = max(life.last + life.offset for life in self._lives.values())
        return found

    def told(self, robots: Collection[str]) -> Iterator[Told]:
        """Yield what is told of some robots, in the order of the times of all files [s, wall time]."""
        readers = (self._timed(file, robots) for file in self._files)
        return (told for _, told in heapq.merge(*readers, key=lambda each: each[0]))

    def _life(self, file: RecordingReader) -> "_Life":
        return self._lives.setdefault(_whose(file), _Life())

    def _look(self, found: Survey, reader: RecordingReader) -> None:
        life, unset = self._life(reader), replace(reader.start, wall_offset=0.0)
        life.shown(reader.start.now, reader.start.wall_offset)
        for entry in reader:
            if isinstance(entry, SpecsText) and found.specs is None:
                found.specs = entry
            if isinstance(entry, Happened) and isinstance(entry.event, SamplePublished):
                found.superseded += entry.event.superseded
            if isinstance(entry, Happened):
                if isinstance(entry.event, ClockChanged):
                    life.shown(entry.event.now, entry.event.wall_offset)
                for command in entry.commands:
                    found.borne.note(reader.start.robot, entry.event.now, command)
            for told in _told(unset, entry, None):
                if isinstance(told, Sample):
                    found.samples[told.robot] += 1
                    life.first, life.last = min(life.first, told.t), max(life.last, told.t)

    def _timed(self, file: RecordingReader, robots: Collection[str]) -> Iterator[tuple[float, Told]]:
        """Yield what a file tells, each with a time that never goes back."""
        last, payload = -float("inf"), None
        start = replace(file.start, wall_offset=self._life(file).offset)
        for entry in file:
            if isinstance(entry, Payload):
                payload = entry
                continue
            for told in _told(start, entry, payload):
                if told.robot in robots:
                    last = max(last, told.t)
                    yield last, told
            payload = None


def _whose(file: RecordingReader) -> tuple[str, str]:
    """Return what tells lives from each other: robot and session; of mere traffic each file has a clock of its own."""
    start = file.start
    return (start.robot, start.zid) if start.kind == "robot" else ("", str(file.path))


def opened(paths: Sequence[Path]) -> tuple[list[RecordingReader], list[str]]:
    """Open files; return those that are recordings, and of each other one why it is none."""
    files, problems = [], []
    for path in paths:
        try:
            files.append(RecordingReader(path))
        except RecordingError as error:
            problems.append(str(error))
    return files, problems


def _told(start: Start, entry: Entry, payload: Payload | None) -> Iterator[Told]:
    """Yield what an entry tells; `payload` is the one before it."""
    offset = start.wall_offset
    if isinstance(entry, Traffic):
        t, data = entry.t_gen + offset, None if payload is None else payload.data
        yield Sample(entry.robot, entry.key, t, t, entry.size, entry.features, payload=data)
    if not isinstance(entry, Happened):
        return
    event = entry.event
    if isinstance(event, SamplePublished) and not event.delete:
        data = payload.data if payload is not None and payload.sample == event.sample else None
        now, t_gen = event.now + offset, event.t_gen + offset
        yield Sample(start.robot, event.key, now, t_gen, event.size, event.features, event.sample, data)
    if isinstance(event, SamplesPassed) and not event.reason.startswith("dropped:"):
        yield Passed(start.robot, event.now + offset, event.count, event.size)
    plan = event.plan if isinstance(event, DecisionReady) else None
    for command in entry.commands:
        if command.get("command") in ("Forward", "Drop"):
            reason, seconds = str(command.get("reason", SENT)), None if plan is None else plan.seconds
            yield Fate(start.robot, int(command["sample"]), reason, event.now + offset, seconds)
            plan = None  # what follows was decided without it
