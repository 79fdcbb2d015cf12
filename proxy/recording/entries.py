"""What stands in a recording, as data. Each kind has a topic of its own; entries stand in the order in which they came.

A recording of a *robot* begins with a `Start` and the specs in force; then come the events of its core. One of
*traffic* begins with a `Start`, too; then come samples, whoever published them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from planner import SearchSettings
from proxy.core.interface import events
from proxy.core.interface.events import Event
from proxy.core.model.settings import CoreSettings

FORMAT = 1
"""Version of the format: what a reader of an earlier one would misread has a greater one."""
PROFILE = "sendworthy"
"""What the header of each file says, in which it differs from other MCAP."""

START, SPECS, SNAPSHOT, TRAFFIC, GAP, END = "start", "specs", "snapshot", "traffic", "gap", "end"
"""Topics of entries that are no events."""
EVENTS = "events/"
"""What the topics of events begin with; then comes the name of the class."""
PAYLOADS = "payloads/"
"""What the topics of payloads begin with; then comes the key."""

EVENT_TYPES: Mapping[str, type[Event]] = {
    name: each
    for name, each in vars(events).items()
    if isinstance(each, type) and issubclass(each, Event) and each is not Event
}
"""All events of the core by name."""


@dataclass(frozen=True, slots=True)
class Start:
    """What a file begins with.

    `kind` tells a robot's life from mere traffic, of which only `source` and `wall_offset` are told. `number` is that
    of the first event in the file; `whole`: the core began with it, at `now` on its clock [s], with these `settings`
    and the specs of that `generation`. Else the file goes on where another one ended, or the recording began later, and
    a `Snapshot` says what the core knew.
    Searches have the settings `search` and a `deadline` [s]. `wall_offset` is what the wall clock shows more than the
    clock of all times in the file [s].
    """

    kind: Literal["robot", "traffic"]
    source: str = ""
    """Where traffic comes from."""
    wall_offset: float = 0.0
    robot: str = ""
    zid: str = ""
    version: str = ""
    """Which Sendworthy recorded."""
    number: int = 0
    whole: bool = False
    now: float = 0.0
    generation: str = ""
    settings: CoreSettings | None = None
    search: SearchSettings | None = None
    deadline: float = 0.0
    payloads: bool = False
    format: int = FORMAT


@dataclass(frozen=True, slots=True)
class SpecFile:
    """A file of utility specs."""

    name: str
    text: str


@dataclass(frozen=True, slots=True)
class SpecsText:
    """Utility specs as they are written; no files where nobody knows what they were read from, or there are none."""

    generation: str
    files: tuple[SpecFile, ...] = ()


@dataclass(frozen=True, slots=True)
class Snapshot:
    """All that the core knew before event `number`, at `now` [s], under the specs of a `generation`.

    `data` is as `pickling.py` writes it, by this `version` of Sendworthy, on this `python`.
    """

    number: int
    now: float
    generation: str
    version: str
    python: str
    data: bytes = field(repr=False)


@dataclass(frozen=True, slots=True)
class Happened:
    """An event that the core took in, and the commands that followed; `fault` is the error that it made instead.

    `number` counts the events of the daemon's life from 0. Commands are plain JSON data: `command` names the class, the
    others are its fields; of a `Decide` they are without the problem, of which `messages` counts what it is about.
    """

    number: int
    event: Event
    commands: tuple[Mapping[str, Any], ...] = ()
    fault: str = ""


@dataclass(frozen=True, slots=True)
class Traffic:
    """A sample that an app of `robot` published at `t_gen` [s]. What it was worth its features tell."""

    robot: str
    key: str
    t_gen: float
    size: int
    features: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Payload:
    """The payload of the sample with this number."""

    sample: int
    key: str
    data: bytes


@dataclass(frozen=True, slots=True)
class Gap:
    """Events from number `first` on are missing, so many, of which so many were samples, because of `reason`.

    `by_event` counts them by class, `payloads` the payloads that are missing, of events that may be there.
    """

    first: int
    events: int
    samples: int = 0
    payloads: int = 0
    reason: str = ""
    by_event: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class End:
    """The file was closed in order: what is missing stands in gaps. `number` would be the next event's."""

    number: int
    reason: str = ""


Entry = Start | SpecsText | Snapshot | Happened | Traffic | Payload | Gap | End
