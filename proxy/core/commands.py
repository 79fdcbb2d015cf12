"""What the core asks its driver to do, in the order given."""

from dataclasses import dataclass
from typing import Literal

from planner import Problem
from proxy.core.wire import Digest, State


@dataclass(frozen=True, slots=True)
class Decide:
    """Search `problem` with `seed` for at most `iterations`; answer with `DecisionReady(ticket)`."""

    ticket: int
    problem: Problem
    seed: int
    iterations: int


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
class SendDigest:
    """Publish our digest on the mesh."""

    digest: Digest


@dataclass(frozen=True, slots=True)
class SendState:
    """Publish our state on the mesh, and answer queries for it with this from now on."""

    state: State


@dataclass(frozen=True, slots=True)
class SetPace:
    """Samples that were decided on go to the mesh no faster than `rate` [B/s, copies counted]: a limit has moved."""

    rate: float


@dataclass(frozen=True, slots=True)
class Notice:
    """A line for the log."""

    level: Literal["info", "warning", "error"]
    text: str


Command = Decide | Forward | Drop | SendDigest | SendState | SetPace | Notice
