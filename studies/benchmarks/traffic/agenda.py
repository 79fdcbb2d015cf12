"""What each robot publishes and when, drawn from a workload: with one seed the same in each flight."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import numpy as np

from studies.simulation.traffic.workloads import Workload

Sample = tuple[float, int, int, int]
"""When it is due after the start [s], stream, number, size [B]."""


@dataclass(frozen=True, slots=True)
class Agenda:
    """The streams of each robot by their kinds, and for `seconds` their samples, in order."""

    workload: Workload
    seconds: float
    robots: tuple[tuple[Sample, ...], ...]

    def of(self, robot: int, name: str) -> dict[str, Any]:
        """Return what the application of a robot of this name reads."""
        kinds = self.workload.robots[robot]
        return {
            "robot": robot,
            "keys": [f"{name}/{kind.name}" for kind in kinds],
            "reliable": [at for at, kind in enumerate(kinds) if kind.alarm],
            "samples": self.robots[robot],
        }


def draw(workload: Workload, seconds: float, seed: int, leave_out: Collection[str] = ()) -> Agenda:
    """Draw what a team publishes; without the kinds to `leave_out` all else stays the same."""
    robots = []
    for robot, kinds in enumerate(workload.robots):
        samples: list[Sample] = []
        for stream, kind in enumerate(kinds):
            random = np.random.default_rng((seed, robot, stream))
            times = kind.times(random, seconds)
            sizes = kind.draw_sizes(random, len(times))
            if kind.name not in leave_out:
                drawn = enumerate(zip(times.tolist(), sizes.tolist(), strict=True))
                samples += [(t, stream, number, int(size)) for number, (t, size) in drawn]
        robots.append(tuple(sorted(samples)))
    return Agenda(workload, seconds, tuple(robots))
