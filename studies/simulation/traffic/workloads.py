"""Workloads of what robots really send, by name: what each robot of a team publishes, and the limit for all."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from planner import Exponential, Linear, Polynomial, Step, Video
from studies.simulation.traffic.kinds import Kind

MBIT = 125_000.0
"""1 Mbit/s [B/s]."""


@dataclass(frozen=True, slots=True)
class Workload:
    """The kinds that each robot publishes, and the limit of all together: `rate` [B/s] in windows of `window` [s]."""

    name: str
    robots: tuple[tuple[Kind, ...], ...]
    rate: float
    window: float

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """All kinds, each once."""
        return tuple(dict.fromkeys(kind for own in self.robots for kind in own))

    def spec(self) -> str:
        """Write the spec of all kinds as an operator would."""
        limit = f'[[constraint]]\nkind = "throughput"\nlimit = "{self.rate!r} B/s"\nwindow = {self.window!r}'
        return "\n\n".join((limit, *(kind.spec() for kind in self.kinds)))


CAMERA = Kind("camera", Video(1 / 30, 10.0), (10, 10), (26_000, 26_000), spread=0.1, jitter=0.005)
SMALL = (
    Kind("odometry", Linear(1.0, 1.0), (20, 20), (116, 116), small=True),
    Kind("telemetry", Linear(1.0, 1 / 2), (5, 5), (138, 138), small=True),
    Kind("log", Linear(1.0, 1 / 5), (2, 2), (80, 400), anew=True, small=True),
    Kind("alarm", Step(1.0, 10.0), (1 / 8, 1 / 8), (76, 76), 20.0, "sum", at_random=True, small=True, alarm=True),
)
WEIGHTS = (1.0, 2.0, 4.0, 8.0, 16.0)
"""Of the robots of *random* in turn."""
RED_CAMERA = Kind("camera", Video(1 / 30, 10.0), (10, 10), (35_000, 35_000), spread=0.1, jitter=0.005, red=True)
RATES, SIZES = (0.2, 10.0), (100.0, 4_000.0)
"""Of the streams of *crowd* [Hz], [B]."""
FULL = 50
"""Robots of a whole crowd."""
CROWD = (
    Kind("pose", Polynomial(1.0, 3.0, 2.0), RATES, SIZES, spread=0.1),
    Kind("battery", Exponential(1.0, 5.0), RATES, SIZES, weight=0.5, spread=0.1),
    Kind("speed", Linear(1.0, 1.0), RATES, SIZES, spread=0.1),
    Kind("detection", Step(1.0, 2.0), RATES, SIZES, weight=4.0, spread=0.1),
    Kind("patch", Video(1 / 30, 10.0), RATES, SIZES, weight=2.0, spread=0.1),
)


def mixed(robots: int = 4) -> Workload:
    """Cameras beside small fast streams: 2.1 Mbit/s a robot, of which 1 Mbit/s fits for all."""
    return Workload("mixed", ((CAMERA, *SMALL),) * robots, MBIT, 0.5)


def random(robots: int = 5) -> Workload:
    """One stream a robot, of samples of any size at any time."""
    weights = [WEIGHTS[robot % len(WEIGHTS)] for robot in range(robots)]
    kinds = {
        weight: Kind(
            f"payload-{weight:.0f}",
            Exponential(1.0, 1.0),
            (5, 15),
            (1_000, 40_000),
            weight,
            anew=True,
            at_random=True,
        )
        for weight in weights
    }
    return Workload("random", tuple((kinds[weight],) for weight in weights), MBIT, 0.5)


def cameras(robots: int = 4) -> Workload:
    """Cameras of which one sees red now and then."""
    return Workload("cameras", ((RED_CAMERA,),) * robots, 2.7 * MBIT, 0.95)


def current_cameras(robots: int = 4) -> Workload:
    """The same, where what an image shows is worth less than nothing when it is no longer there."""
    camera = replace(RED_CAMERA, aggregation="current")
    return replace(cameras(robots), name="cameras-current", robots=((camera,),) * robots)


def crowd(robots: int = FULL) -> Workload:
    """Many robots with small streams of all rates; fewer have a part of the limit."""
    return Workload("crowd", (CROWD,) * robots, 2 * MBIT * robots / FULL, 0.5)


WORKLOADS: dict[str, Callable[[int], Workload]] = {
    "mixed": mixed,
    "random": random,
    "cameras": cameras,
    "cameras-current": current_cameras,
    "crowd": crowd,
}
"""All but *uniform*, which is the equal messages of the simulation study (§4.2)."""
