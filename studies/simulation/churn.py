"""What happens to a team in flight: robots come, go and subscribe, the mesh falls apart and together again."""

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Join:
    """The robot starts at `t` [s], not before; after a `Leave` or a `Crash` it starts anew, with a new id."""

    t: float
    robot: str


@dataclass(frozen=True, slots=True)
class Leave:
    """The robot says that it goes."""

    t: float
    robot: str


@dataclass(frozen=True, slots=True)
class Crash:
    """The robot is gone without a word: its token is lost later."""

    t: float
    robot: str


@dataclass(frozen=True, slots=True)
class Partition:
    """From `t` [s] on only robots of one group hear each other; those of no group hear nobody."""

    t: float
    groups: tuple[frozenset[str], ...]


@dataclass(frozen=True, slots=True)
class Merge:
    """All hear each other again."""

    t: float


@dataclass(frozen=True, slots=True)
class Subscribe:
    """The robot's applications subscribe to these key expressions from now on, and to no others."""

    t: float
    robot: str
    keys: tuple[str, ...]


Happening = Join | Leave | Crash | Partition | Merge | Subscribe


def joining(happenings: Iterable[Happening]) -> frozenset[str]:
    """Return the robots that are not there from the start: what happens to them first is that they join."""
    first: dict[str, Happening] = {}
    for each in sorted(happenings, key=lambda happening: happening.t):
        if isinstance(each, Join | Leave | Crash):
            first.setdefault(each.robot, each)
    return frozenset(robot for robot, each in first.items() if isinstance(each, Join))
