"""The world of the mission: robots that drive in circles on a plain, and what stands there.

Everything is a function of the seed and the time, so that each robot's camera knows the whole world by itself. Lengths
are in metres, angles in radians against the x axis, times in seconds of the run.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

SPEED = 0.22
"""Of a robot [m/s]."""
SPACING = 5.0
"""Between the middles of the circles of neighbours [m]: they meet now and then."""
RADII = 3.0, 4.5
CLOSEST = 2.2
"""A red object is taken out of a robot's way when the robot has come so close [m]."""
POSTS_EACH = 4
"""How many posts and boxes there are for each robot."""


class Pose(NamedTuple):
    """Where something is, and where it looks."""

    x: float
    y: float
    heading: float


@dataclass(frozen=True, slots=True)
class Episode:
    """A red object stands in the way of robot number `robot` from `start` to `end`."""

    robot: int
    start: float
    end: float


class Post(NamedTuple):
    """Something that stands there and is not red: `kind` says how it looks, from 0 to 1."""

    x: float
    y: float
    height: float
    kind: float


class World:
    """Where the robots are at any time, and what stands around."""

    def __init__(self, seed: int, robots: int) -> None:
        rng = np.random.default_rng((seed, 4))
        columns = math.ceil(math.sqrt(robots))
        places = [(SPACING * (i % columns), SPACING * (i // columns)) for i in range(robots)]
        jitter = rng.uniform(-0.8, 0.8, (robots, 2))
        self._middles = [(x + jitter[i, 0], y + jitter[i, 1]) for i, (x, y) in enumerate(places)]
        self._radii = rng.uniform(*RADII, robots)
        self._phases = rng.uniform(0.0, 2.0 * math.pi, robots)
        self._turns = rng.choice((-1.0, 1.0), robots)
        reach = SPACING * columns + RADII[1]
        spread = rng.uniform((-RADII[1] - 4.0, -RADII[1] - 4.0), (reach, reach), (POSTS_EACH * robots + 4, 2))
        looks = rng.uniform(0.0, 1.0, (len(spread), 2))
        self.posts = tuple(
            Post(float(x), float(y), 0.8 + 1.8 * float(height), float(kind))
            for (x, y), (height, kind) in zip(spread, looks, strict=True)
        )
        self.robots = robots

    def pose(self, robot: int, t: float) -> Pose:
        """Return where a robot is at a time, and where it looks."""
        radius, turn = float(self._radii[robot]), float(self._turns[robot])
        angle = float(self._phases[robot]) + turn * SPEED / radius * t
        x, y = self._middles[robot]
        return Pose(
            float(x) + radius * math.cos(angle), float(y) + radius * math.sin(angle), angle + turn * math.pi / 2
        )

    def place(self, episode: Episode) -> tuple[float, float]:
        """Return where the red object of an episode stands: ahead of its robot, which comes `CLOSEST` in the end."""
        x, y, heading = self.pose(episode.robot, episode.end)
        return x + CLOSEST * math.cos(heading), y + CLOSEST * math.sin(heading)


def schedule(seed: int, robots: int, seconds: float) -> tuple[Episode, ...]:
    """In whose way red objects stand when: one robot at a time for 3 to 6 s, with gaps of 1 to 2.5 s between."""
    rng = np.random.default_rng((seed, 1))
    episodes: list[Episode] = []
    time = float(rng.uniform(1.0, 1.5))
    while time < seconds:
        others = [robot for robot in range(robots) if robots == 1 or not episodes or robot != episodes[-1].robot]
        length = float(rng.uniform(3.0, 6.0))
        episodes.append(Episode(int(rng.choice(others)), time, time + length))
        time += length + float(rng.uniform(1.0, 2.5))
    return tuple(episodes)


def phases(seed: int, robots: int, period: float) -> tuple[float, ...]:
    """When within a period each robot's camera takes its frames [s]: spread, but not evenly."""
    jitter = np.random.default_rng((seed, 2)).uniform(-0.25, 0.25, robots)
    return tuple(float(period * ((robot + 0.5 + jitter[robot]) / robots)) for robot in range(robots))


def moment(episodes: Sequence[Episode], seconds: float) -> float:
    """Choose when to photograph the screens [s]: late in the last longer episode, which had time to come."""
    last = max(episodes, key=lambda e: (min(e.end, seconds) - e.start > LATELY + 0.5, e.start), default=None)
    if last is None:
        return 0.9 * seconds
    return min(last.end - 0.3, seconds - 0.2)


LATELY = 2.0
"""The frame rate in a caption of the screens is that of this time before the moment [s]."""
