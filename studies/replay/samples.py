"""What a recording tells of the samples that applications published, whatever it was recorded by."""

from collections.abc import Mapping
from dataclasses import dataclass, field

SENT = "forwarded"
"""What became of a sample that went to the mesh."""


@dataclass(frozen=True, slots=True)
class Sample:
    """An application of `robot` published `size` bytes at `t` [s]; the sample was generated at `t_gen` [s].

    `number` tells it from all others of its recording, `payload` is empty where it was not recorded.
    """

    robot: str
    key: str
    t: float
    t_gen: float
    size: int
    features: Mapping[str, float] = field(default_factory=dict)
    number: int = 0
    payload: bytes | None = None


@dataclass(frozen=True, slots=True)
class Fate:
    """What became at `t` [s] of the sample with this number of a robot: `SENT`, or why it was dropped.

    `seconds` is what the search for it took; None: there was none.
    """

    robot: str
    number: int
    reason: str
    t: float
    seconds: float | None = None


@dataclass(frozen=True, slots=True)
class Passed:
    """So many samples of `size` bytes in all left a robot at `t` [s], of which nothing else is known."""

    robot: str
    t: float
    count: int
    size: int


Told = Sample | Fate | Passed
