"""What happened in a run, event by event; every figure of the demo is computed from these alone.

One line of JSON each, in a file for all runs. Times are seconds of CLOCK_MONOTONIC, sizes are bytes.
"""

import json
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, ClassVar, TypeAlias


@dataclass(frozen=True, slots=True)
class Run:
    """A run starts: its conditions. `rate` is the medium's, `limit` the spec's [bit/s]."""

    KIND: ClassVar[str] = "run"
    phase: str
    start: float
    seconds: float
    robots: tuple[str, ...]
    rate: float
    limit: float
    window: float


@dataclass(frozen=True, slots=True)
class Publish:
    """An app published a frame; `red` is the fraction of it that is red."""

    KIND: ClassVar[str] = "publish"
    phase: str
    robot: str
    number: int
    t: float
    size: int
    red: float


@dataclass(frozen=True, slots=True)
class Tell:
    """An app published a robot's position or charge: `what`."""

    KIND: ClassVar[str] = "tell"
    phase: str
    robot: str
    what: str
    t: float
    size: int


@dataclass(frozen=True, slots=True)
class Receive:
    """The operator's app received a frame."""

    KIND: ClassVar[str] = "receive"
    phase: str
    robot: str
    number: int
    t: float
    t_gen: float
    size: int


EVERYONE = "everyone"
"""Source and sink where the kernel is the medium, which does not say who sent what to whom."""


@dataclass(frozen=True, slots=True)
class Serve:
    """The medium carried a chunk."""

    KIND: ClassVar[str] = "serve"
    phase: str
    t: float
    source: str
    sink: str
    size: int


@dataclass(frozen=True, slots=True)
class Counts:
    """What a daemon counted of its own robot's samples, at the end."""

    KIND: ClassVar[str] = "counts"
    phase: str
    robot: str
    received: int
    forwarded: int
    dropped: int
    queued: int


@dataclass(frozen=True, slots=True)
class Links:
    """A look at all connections between the processes: how many end at the medium, and how many avoid it."""

    KIND: ClassVar[str] = "links"
    phase: str
    t: float
    medium: int
    direct: int


Event: TypeAlias = Run | Publish | Tell | Receive | Serve | Counts | Links
"""Something that happened in the run `phase`: "without" or "with" the filter, "downsampled" or "random"."""

KINDS: dict[str, type[Event]] = {kind.KIND: kind for kind in (Run, Publish, Tell, Receive, Serve, Counts, Links)}


def to_line(event: Event) -> str:
    """Return the event as a line of JSON."""
    return json.dumps({"event": event.KIND} | asdict(event)) + "\n"


def from_line(line: str, phase: str | None = None) -> Event:
    """Read an event; `phase` where the line, as a process of the demo wrote it, does not say."""
    fields: dict[str, Any] = json.loads(line)
    kind = KINDS[fields.pop("event")]
    fields.setdefault("phase", phase)
    if "robots" in fields:
        fields["robots"] = tuple(fields["robots"])
    return kind(**fields)


def write_events(path: Path, events: Iterable[Event]) -> None:
    """Write a file of events."""
    with path.open("w") as file:
        file.writelines(to_line(event) for event in events)


def read_events(path: Path, phase: str | None = None) -> Iterator[Event]:
    """Read a file of events; a last line that was cut short, because its writer was ended, is left out."""
    with path.open() as file:
        for line in file:
            if line.endswith("\n"):
                yield from_line(line, phase)
