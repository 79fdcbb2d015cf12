"""One flight of the study, as data: what is flown, by whom, over which network; and its key in the store."""

import hashlib
import json
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal, Self

VERSION = 1
"""Of the study: records of another one are flown anew."""

NetworkName = Literal["adhoc", "infrastructure", "own"]
Generation = Literal["periodic", "aperiodic"]
Aggregations = Literal["most_recent", "sum", "mixed"]

MISSION = ("scenario", "level", "seed", "robots", "seconds", "latency", "window", "generation", "aggregation")
"""Fields that say which mission is flown: contenders with the same ones can be compared with its bound."""

REAL_TRAFFIC = "real-"
"""So scenarios begin that are a workload of what robots really send; its name follows."""
ITERATIONS = 300
"""Of a search, where nothing else is said."""
REAL = ("level", "seconds", "latency", "loss", "window", "exploration", "background")


@dataclass(frozen=True, slots=True)
class Task:
    """A contender flies a mission of §4.2, or one of real traffic, for `seconds` after the warm-up.

    `level` is the limit in messages per 2.5 s whatever the `window` is [s] or, of contenders that know no limit, the
    probability to send. In `unicast` an operator wants everything, else every robot does, and all broadcast. `latency`
    is added to that of the network [s], `loss` a probability. `exploration` is c of Eq. 3. `background` is other
    traffic on the channel [B/s]. With `adaptive` the team has to find its limit.
    """

    contender: str
    scenario: str
    level: float
    seed: int
    network: NetworkName = "adhoc"
    unicast: bool = False
    robots: int = 10
    seconds: float = 100.0
    latency: float = 0.0
    loss: float = 0.0
    window: float = 2.5
    iterations: int = ITERATIONS
    exploration: float = 0.35
    background: float = 0.0
    adaptive: bool = False
    generation: Generation = "periodic"
    aggregation: Aggregations = "most_recent"

    def __post_init__(self) -> None:
        for name in REAL:  # 5 and 5.0 are the same task, and have to have the same key
            object.__setattr__(self, name, float(getattr(self, name)))

    @property
    def key(self) -> str:
        """Return what the store knows it by: a hash of everything that matters, and of the version of the study."""
        text = json.dumps([VERSION, self.as_dict()], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:20]

    @property
    def workload(self) -> str:
        """Return the workload of real traffic that is flown, which has a limit of its own; empty: none."""
        return self.scenario.removeprefix(REAL_TRAFFIC) if self.scenario.startswith(REAL_TRAFFIC) else ""

    @property
    def mission(self) -> tuple[Any, ...]:
        """Return which mission it is, by the values of `MISSION`."""
        return tuple(getattr(self, name) for name in MISSION)

    def but(self, **changes: Any) -> Self:
        """Return the task with some things changed."""
        return replace(self, **changes)

    def as_dict(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        return asdict(self)

    @classmethod
    def from_dict(cls, given: dict[str, Any]) -> Self:
        """Return the task that `as_dict` wrote."""
        return cls(**given)
