"""Who wants what: an operator alone, all robots besides, or some; and what the operator looks at changes.

On robots hardly any stream goes to one receiver for as long as the team flies. Poses go to all, in as many copies, and
of the cameras an operator opens one after the other. Nobody had flown that: teams reach 95 % of a central decider in
the mean, but 45 to 85 where words are scarce, as each stream that is new asks for a part of its own.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from studies.simulation.churn import Subscribe
from studies.simulation.missions import OPERATOR
from studies.simulation.traffic.kinds import Kind, middle
from studies.simulation.traffic.workloads import Workload

VIEWED = 0.3
"""So many kinds are looked at of one robot at a time, as a part; of the others..."""
SHARED = 0.5
"""... this part goes to robots, too..."""
EVERYBODY, EACH = 0.5, 0.5
"""... to all with this probability, else to each with this one..."""
LARGEST = 0.6
"""... where all copies of a sample take no more of the limit: who sets a limit knows what its robots share."""
VIEWS = (6.0, 14.0)
"""After so long the operator looks at another robot's stream of one kind [s]."""
TOLD = (
    "half of the kinds go to the operator alone, some to robots, too (`for`: so many want them, their publisher"
    " included), and of some the operator looks at one robot at a time (`viewed`); each 6 to 14 s it looks at another"
    " one's stream of one of these kinds. What all get counts, also what was seen last where nobody looks any more."
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

    def copies(self, robot: str, streams: int) -> float:
        """Return in how many copies a sample of a robot's stream is wanted in the mean, where there are so many."""
        return 1.0 / streams if self.viewed else 1.0 + len(set(self.robots) - {robot})


@dataclass(frozen=True, slots=True)
class Interests:
    """What each robot and the operator subscribe to at first, and how that changes."""

    first: Mapping[str, tuple[str, ...]]
    changes: tuple[Subscribe, ...]


def audiences(draw: np.random.Generator, workload: Workload) -> dict[str, Audience]:
    """Draw who wants each kind, by its name."""
    return {kind.name: _audience(draw, workload, kind) for kind in workload.kinds}


def offered(workload: Workload, of: Mapping[str, Audience]) -> float:
    """Return what is published of what is wanted, in all copies [B/s]."""
    total = 0.0
    for kind in workload.kinds:
        having = _having(workload, kind)
        copies = sum(of[kind.name].copies(robot, len(having)) for robot in having)
        total += copies * middle(kind.rates) * middle(kind.sizes)
    return total


def interests(draw: np.random.Generator, workload: Workload, of: Mapping[str, Audience], seconds: float) -> Interests:
    """Draw what the operator looks at in a flight so long [s]; return what all subscribe to."""
    keys = {kind.name: tuple(f"{robot}/{kind.name}" for robot in _having(workload, kind)) for kind in workload.kinds}
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
    robots = [robot for robot in _robots(workload) if everybody < EVERYBODY or draw.random() < EACH]
    if viewed < VIEWED:
        return Audience(viewed=True)
    all_copies = middle(kind.sizes) * (len(robots) + 1) / (workload.rate * workload.window)
    return Audience(tuple(robots) if shared < SHARED and all_copies <= LARGEST else ())


def _changes(
    draw: np.random.Generator,
    always: list[str],
    keys: Mapping[str, tuple[str, ...]],
    looks_at: dict[str, str],
    seconds: float,
) -> Iterator[Subscribe]:
    """Yield what the operator subscribes to as it looks at another robot's stream of one kind."""
    t, several = float(draw.uniform(*VIEWS)), [name for name in looks_at if len(keys[name]) > 1]
    while several and t < seconds:
        name = str(draw.choice(several))
        looks_at[name] = str(draw.choice([key for key in keys[name] if key != looks_at[name]]))
        yield Subscribe(t, OPERATOR, (*always, *looks_at.values()))
        t += float(draw.uniform(*VIEWS))


def _robots(workload: Workload) -> list[str]:
    return [f"r{place}" for place in range(len(workload.robots))]


def _having(workload: Workload, kind: Kind) -> list[str]:
    """Return the robots that publish a kind."""
    return [robot for robot, own in zip(_robots(workload), workload.robots, strict=True) if kind in own]
