"""What the core asks its driver to do, in the order given."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from planner import Problem
from proxy.core.protocol.messages import Digest, State


@dataclass(frozen=True, slots=True)
class Decide:
    """Search `problem` with `seed` for at most `iterations`; answer with `DecisionReady(ticket)`.

    The deadline counts from `asked` [s]; when it passes the driver sends `DecisionLate(ticket)`.
    """

    ticket: int
    problem: Problem
    seed: int
    iterations: int
    asked: float


@dataclass(frozen=True, slots=True)
class Forward:
    """Publish the sample on the mesh; answer with `SampleHanded` or `SampleRefused`."""

    sample: int


@dataclass(frozen=True, slots=True)
class Drop:
    """Forget the sample: it never reaches the mesh. `reason` is one of the `dropped:…` reasons."""

    sample: int
    reason: str


@dataclass(frozen=True, slots=True)
class Keep:
    """Keep the payload of a sample until `Forget`, whatever else becomes of the sample."""

    sample: int


@dataclass(frozen=True, slots=True)
class Forget:
    """The kept payload of a sample is needed no more."""

    sample: int


@dataclass(frozen=True, slots=True)
class SendCopy:
    """Send a sample that is kept only to the robot with the tag `to`; answer with `CopyHanded` or `CopyRefused`."""

    sample: int
    to: str


@dataclass(frozen=True, slots=True)
class TellBacklog:
    """Tell the robot with the tag `to` for which keys copies wait for it: new samples of these overtake the copies.

    `keys` are None where they cannot be named. The greatest `number` holds. Unless it `grows` it must not overtake
    copies.
    """

    to: str
    number: int
    keys: tuple[str, ...] | None
    grows: bool


@dataclass(frozen=True, slots=True)
class Retain:
    """Take what apps publish on these key expressions (all of them), even if nobody who is here wants it."""

    expressions: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Reread:
    """Extract the features of the sample again, by the specs in force now; answer with `SampleReread`."""

    sample: int
    key: str


@dataclass(frozen=True, slots=True)
class SendDigest:
    """Publish our digest on the mesh."""

    digest: Digest


@dataclass(frozen=True, slots=True)
class SendState:
    """Answer queries with our state from now on, and publish it on the mesh, or the `update` instead of it."""

    state: State
    update: State | None = None


@dataclass(frozen=True, slots=True)
class AskState:
    """Ask the robot with this name and tag for its state."""

    robot: str
    tag: str


@dataclass(frozen=True, slots=True)
class NoteInterest:
    """The apps of the robot with this session subscribe to these key expressions: what we publish goes there."""

    zid: str
    subscriptions: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class SetPace:
    """Samples that were decided on go to the mesh no faster than `rate` [B/s, copies counted]: a limit changed."""

    rate: float


@dataclass(frozen=True, slots=True)
class Notice:
    """A line for the log; `fields` are what programs look for in it, with the `reason` of which few are logged."""

    level: Literal["info", "warning", "error"]
    text: str
    fields: Mapping[str, str | int]


Command = (
    Decide
    | Forward
    | Drop
    | Keep
    | Forget
    | SendCopy
    | TellBacklog
    | Retain
    | Reread
    | SendDigest
    | SendState
    | AskState
    | NoteInterest
    | SetPace
    | Notice
)
