"""Who wants what: an operator alone, all robots besides, or some; and what the operator looks at changes.

On robots hardly any stream goes to one receiver for as long as the team flies. Poses go to all, in as many copies, and
of the cameras an operator opens one after the other. Nobody had flown that: teams in which words are scarce reached 45
to 85 % of a central decider, as each new stream asks for a part of its own.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from studies.simulation.churn import Subscribe
from studies.simulation.missions import OPERATOR
from studies.simulation.traffic.kinds import Kind
from studies.simulation.traffic.workloads import Workload

VIEWED = 0.3
"""So many kinds are looked at of one robot at a time, as a part; of the others..."""
SHARED = 0.5
"""... this part goes to robots, too: half of those to all, half to each with this probability..."""
LARGEST = 0.6
"""... where all copies of a sample take no more of the limit: who sets a limit knows what its robots share."""
VIEWS = (6.0, 14.0)
"""The operator looks at something else after so long [s]."""
TOLD = (
    "half of the kinds go to the operator alone, some to robots, too (`for`: so many want them), and of some it looks"
    " at one robot at a time (`viewed`), at another after 6 to 14 s. What all get counts."
)
"""What pages say of them."""


@dataclass(frozen=True, slots=True)
class Audience:
    """Who wants a kind: an operator, one robot's at a time if it is `viewed`, and these robots, but for their own."""

    robots: tuple[str, ...] = ()
    viewed: bool = False

    @property
    def label(self) -> str:
        """Tell it in a word."""
        return "viewed" if self.viewed else f"for {len(self.robots) + 1}"


@dataclass(frozen=True, slots=True)
class Interests:
    """What each robot and the operator subscribe to at first, and how that changes."""

    first: Mapping[str, tuple[str, ...]]
    changes: tuple[Subscribe, ...]


def audiences(draw: np.random.Generator, workload: Workload) -> dict[str, Audience]:
    """Draw who wants each kind, by its name."""
    return {kind.name: _audience(draw, workload, kind) for kind in workload.kinds}


def interests(draw: np.random.Generator, workload: Workload, of: Mapping[str, Audience], seconds: float) -> Interests:
    """Draw what the operator looks at in a flight so long [s]; return what all subscribe to."""
    keys = {kind.name: _keys(workload, kind) for kind in workload.kinds}
    viewed = [name for name, audience in of.items() if audience.viewed]
    looks_at = {name: str(draw.choice(keys[name])) for name in viewed}
    always = [key for name, own in keys.items() if name not in viewed for key in own]
    first = {OPERATOR: (*always, *looks_at.values())}
    for robot in _robots(workload):
        shared = (key for name, own in keys.items() if robot in of[name].robots for key in own)
        first[robot] = tuple(key for key in shared if not key.startswith(f"{robot}/"))
    return Interests(first, tuple(_changes(draw, always, keys, looks_at, seconds)))


def _audience(draw: np.random.Generator, workload: Workload, kind: Kind) -> Audience:
    viewed, shared, everybody = (float(draw.random()) for _ in range(3))
    robots = [robot for robot in _robots(workload) if everybody < 0.5 or draw.random() < SHARED]
    if viewed < VIEWED:
        return Audience(viewed=True)
    copies = float(np.sqrt(np.prod(kind.sizes))) * (len(robots) + 1) / (workload.rate * workload.window)
    return Audience(tuple(robots) if shared < SHARED and copies <= LARGEST else ())


def _changes(
    draw: np.random.Generator,
    always: list[str],
    keys: Mapping[str, tuple[str, ...]],
    looks_at: dict[str, str],
    seconds: float,
) -> Iterator[Subscribe]:
    """Yield what the operator subscribes to as it looks at another robot's stream of one kind."""
    t = float(draw.uniform(*VIEWS))
    while looks_at and t < seconds:
        name = str(draw.choice(list(looks_at)))
        looks_at[name] = str(draw.choice(keys[name]))
        yield Subscribe(t, OPERATOR, (*always, *looks_at.values()))
        t += float(draw.uniform(*VIEWS))


def _robots(workload: Workload) -> list[str]:
    return [f"r{place}" for place in range(len(workload.robots))]


def _keys(workload: Workload, kind: Kind) -> tuple[str, ...]:
    """Return the keys of a kind's streams."""
    having = zip(_robots(workload), workload.robots, strict=True)
    return tuple(f"{robot}/{kind.name}" for robot, own in having if kind in own)
