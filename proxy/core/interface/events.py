"""What can happen to the core, in [s] on the daemon's monotonic clock and [B]; `sample` is the driver's number."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from planner import Plan
from proxy.core.interface.commands import Command
from proxy.core.model.mode import Mode
from proxy.core.protocol.messages import Digest, State
from utility_specs import Specs


@dataclass(frozen=True, slots=True)
class Event:
    """Something happened at `now`."""

    now: float


@dataclass(frozen=True, slots=True)
class SamplePublished(Event):
    """An app on this robot published a sample that an information type covers.

    `origin` is the id inside its timestamp (hex, None: unstamped by the app), `priority` Zenoh's (1 real time … 7
    background), `delete` a deletion of the key; `superseded` samples gave way to it since the last event of the stream.
    """

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
class SampleReread(Event):
    """These are the features of a waiting sample by the specs in force now."""

    sample: int
    features: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class SamplesPassed(Event):
    """Samples went straight to the mesh session: no spec covers them, or the mode is `pass`."""

    reason: str
    count: int
    size: int


@dataclass(frozen=True, slots=True)
class SampleHanded(Event):
    """A sample that the core forwarded was handed to the mesh session."""

    sample: int


@dataclass(frozen=True, slots=True)
class SampleRefused(Event):
    """A sample that the core forwarded could not be handed over (session closed, error), or is gone."""

    sample: int
    reason: str = "dropped:egress"


@dataclass(frozen=True, slots=True)
class CopyHanded(Event):
    """A sample that was kept for the robot with the tag `to` was handed to the mesh session."""

    sample: int
    to: str


@dataclass(frozen=True, slots=True)
class CopyRefused(Event):
    """A sample that was kept for the robot with the tag `to` could not be handed over."""

    sample: int
    to: str


@dataclass(frozen=True, slots=True)
class SampleHeard(Event):
    """A sample arrived from the mesh. `stamp` is its timestamp as wall time [s], `origin` the id in it (hex)."""

    key: str
    size: int
    origin: str | None
    stamp: float | None
    features: Mapping[str, float] | None


@dataclass(frozen=True, slots=True)
class DigestHeard(Event):
    """Another robot's digest of so many bytes arrived."""

    digest: Digest
    size: int = 0


@dataclass(frozen=True, slots=True)
class StateHeard(Event):
    """Another robot's state of so many bytes arrived: published as it changed, or fetched as we asked for it."""

    state: State
    size: int = 0


@dataclass(frozen=True, slots=True)
class MalformedHeard(Event):
    """`count` messages on a Sendworthy key were no digest and no state; `kind` says on which, and what was wrong."""

    robot: str
    kind: str = "malformed"
    count: int = 1


@dataclass(frozen=True, slots=True)
class VersionHeard(Event):
    """The robot with this tag speaks this version of the protocol, whether we understand it or not."""

    tag: str
    version: int


@dataclass(frozen=True, slots=True)
class StateAsked(Event):
    """Another robot asked for our state, and was answered."""


@dataclass(frozen=True, slots=True)
class PeerAppeared(Event):
    """A robot's presence token appeared on the mesh."""

    robot: str
    zid: str


@dataclass(frozen=True, slots=True)
class PeerGone(Event):
    """A robot's presence token vanished."""

    robot: str
    zid: str


@dataclass(frozen=True, slots=True)
class InterestChanged(Event):
    """The apps of this robot now subscribe to these key expressions (all of them)."""

    keys: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class MatchingChanged(Event):
    """Whether anybody on the mesh subscribes to one of our keys, as Zenoh itself knows it."""

    key: str
    matching: bool


@dataclass(frozen=True, slots=True)
class ClockChanged(Event):
    """Our wall clock is `wall_offset` [s] ahead of the monotonic clock, wrong by `error` at most; 0.0: unknown."""

    wall_offset: float
    error: float = 0.0


@dataclass(frozen=True, slots=True)
class LinksGauged(Event):
    """How long what we send now takes to leave: `waits` are session ids of robots and times [s], of links in use."""

    waits: tuple[tuple[str, float], ...]


@dataclass(frozen=True, slots=True)
class SpecsChanged(Event):
    """The utility specs were swapped whole."""

    specs: Specs


@dataclass(frozen=True, slots=True)
class ModeChanged(Event):
    """An operator switched the mode."""

    mode: Mode


@dataclass(frozen=True, slots=True)
class DecisionReady(Event):
    """The worker's answer to a `Decide`; `plan` is None when the planner failed with `error`.

    `overhead` is all but the search after its first iteration [s]; that was `cut` if it ended for want of time.
    """

    ticket: int
    plan: Plan | None
    error: str = ""
    overhead: float = 0.0
    cut: bool = False


@dataclass(frozen=True, slots=True)
class DecisionLate(Event):
    """The deadline of a `Decide` has passed without an answer; a later answer changes nothing."""

    ticket: int


@dataclass(frozen=True, slots=True)
class TimePassed(Event):
    """Nothing happened but time; the driver sends it at the core's `wake_at` at the latest."""


class Taker(Protocol):
    """Takes in events, and says what is to be done: a core, or whoever stands before one and notes what it does."""

    def handle(self, event: Event) -> list[Command]:
        """Take in one event; return what is to be done, in order."""

    def pass_on(self, event: Event) -> list[Command] | None:
        """Do the same, if all that is to be done is to send a sample on or to note that it went; None: it is not."""
