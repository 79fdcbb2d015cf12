"""What can happen to the core. Times are seconds on the daemon's monotonic clock, sizes are bytes.

A sample's payload stays with the driver; the core speaks of it by the integer `sample` the driver gave it.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from planner import Plan
from proxy.core.model.mode import Mode
from proxy.core.protocol.messages import Digest, State
from utility_specs import Specs


@dataclass(frozen=True, slots=True)
class SamplePublished:
    """An app on this robot published a sample that an information type covers.

    `t_gen` is its generation time, `origin` the id inside its timestamp (hex, None: unstamped by the app),
    `priority` is Zenoh's (1 real time … 7 background), `features` what its type extracts. `delete` marks a
    deletion of the key: it passes. `superseded` samples of the stream came before it since the last one told of, and
    gave way to it.
    """

    now: float
    sample: int
    key: str
    size: int
    t_gen: float
    origin: str | None
    priority: int
    features: Mapping[str, float]
    delete: bool = False
    superseded: int = 0


@dataclass(frozen=True, slots=True)
class SampleReread:
    """The features of a sample that waits are these by the specs in force now."""

    now: float
    sample: int
    features: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class SamplesPassed:
    """Samples went straight to the mesh session: no spec covers them, or the mode is `pass`."""

    now: float
    reason: str
    count: int
    size: int


@dataclass(frozen=True, slots=True)
class SampleHanded:
    """A sample that the core forwarded was handed to the mesh session."""

    now: float
    sample: int


@dataclass(frozen=True, slots=True)
class SampleRefused:
    """A sample that the core forwarded could not be handed over (session closed, error), or is gone."""

    now: float
    sample: int
    reason: str = "dropped:egress"


@dataclass(frozen=True, slots=True)
class CopyHanded:
    """A sample that was kept for the robot with the tag `to` was handed to the mesh session."""

    now: float
    sample: int
    to: str


@dataclass(frozen=True, slots=True)
class CopyRefused:
    """A sample that was kept for the robot with the tag `to` could not be handed over."""

    now: float
    sample: int
    to: str


@dataclass(frozen=True, slots=True)
class SampleHeard:
    """A sample arrived from the mesh. `stamp` is its timestamp as wall time [s], `origin` the id in it (hex)."""

    now: float
    key: str
    size: int
    origin: str | None
    stamp: float | None
    features: Mapping[str, float] | None


@dataclass(frozen=True, slots=True)
class DigestHeard:
    """Another robot's digest of so many bytes arrived."""

    now: float
    digest: Digest
    size: int = 0


@dataclass(frozen=True, slots=True)
class StateHeard:
    """Another robot's state of so many bytes arrived (published on change, or fetched: it was there before us)."""

    now: float
    state: State
    size: int = 0


@dataclass(frozen=True, slots=True)
class MalformedHeard:
    """Something on a Sendworthy key was no digest and no state; `kind` says on which, and what was wrong."""

    now: float
    robot: str
    kind: str = "malformed"
    count: int = 1
    """So many of them."""


@dataclass(frozen=True, slots=True)
class VersionHeard:
    """A robot with this tag speaks a version of the protocol, whether we understand it or not."""

    now: float
    tag: str
    version: int


@dataclass(frozen=True, slots=True)
class StateAsked:
    """Another robot asked for our state, and was answered."""

    now: float


@dataclass(frozen=True, slots=True)
class PeerAppeared:
    """A robot's presence token appeared on the mesh."""

    now: float
    robot: str
    zid: str


@dataclass(frozen=True, slots=True)
class PeerGone:
    """A robot's presence token vanished."""

    now: float
    robot: str
    zid: str


@dataclass(frozen=True, slots=True)
class InterestChanged:
    """The apps of this robot now subscribe to these key expressions (all of them)."""

    now: float
    keys: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class MatchingChanged:
    """Whether anybody on the mesh subscribes to one of our keys, as Zenoh itself knows it."""

    now: float
    key: str
    matching: bool


@dataclass(frozen=True, slots=True)
class ClockChanged:
    """Our wall clock shows `wall_offset` [s] more than the monotonic clock, wrong by `error` at most; 0.0: unknown."""

    now: float
    wall_offset: float
    error: float = 0.0


@dataclass(frozen=True, slots=True)
class LinksGauged:
    """How long what we send now is on its way, as the driver sees it: `waits` are ids of robots and times [s].

    Links that sent nothing lately are left out.
    """

    now: float
    waits: tuple[tuple[str, float], ...]


@dataclass(frozen=True, slots=True)
class SpecsChanged:
    """The utility specs were swapped whole."""

    now: float
    specs: Specs


@dataclass(frozen=True, slots=True)
class ModeChanged:
    """An operator switched the mode."""

    now: float
    mode: Mode


@dataclass(frozen=True, slots=True)
class DecisionReady:
    """The worker's answer to a `Decide`; `plan` is None when the planner failed with `error`.

    Of the time since what asked for it `overhead` is what was not spent on searching, but for the first iteration [s].
    """

    now: float
    ticket: int
    plan: Plan | None
    error: str = ""
    overhead: float = 0.0


@dataclass(frozen=True, slots=True)
class DecisionLate:
    """The deadline of a `Decide` is over, and there is no answer; one that comes later changes nothing."""

    now: float
    ticket: int


@dataclass(frozen=True, slots=True)
class TimePassed:
    """Nothing happened but time; the driver sends it at the core's `wake_at` at the latest."""

    now: float


Event = (
    SamplePublished
    | SampleReread
    | SamplesPassed
    | SampleHanded
    | SampleRefused
    | CopyHanded
    | CopyRefused
    | SampleHeard
    | DigestHeard
    | StateHeard
    | MalformedHeard
    | VersionHeard
    | StateAsked
    | PeerAppeared
    | PeerGone
    | InterestChanged
    | MatchingChanged
    | ClockChanged
    | LinksGauged
    | SpecsChanged
    | ModeChanged
    | DecisionReady
    | DecisionLate
    | TimePassed
)
