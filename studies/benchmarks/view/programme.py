"""What is flown for the page: every arrangement under every condition."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

from studies.benchmarks.view.flown import Course, Flight
from studies.simulation.churn import Crash, Join, Leave
from studies.simulation.clocks import Clock, booted_without_time
from studies.simulation.conditions import WARM_UP, Conditions, Coordination, Transport

LATENCY, LOSS = 0.02, 0.01
"""Where nothing else is said [s], and as a probability."""
FAR, CLOCK_ERROR = 1.0, 0.005
"""The latency that is compared with the usual one, and what wall clocks may be wrong by where that is known [s]."""
SKEW, STEP = 10.0, 60.0
"""How far clocks are off, one way and the other, and by how much they step [s]."""
JITTER = 0.1
"""Of generation times where forecasts are looked at [s]; a period is about a second."""

ARRANGEMENTS: tuple[tuple[Coordination, Transport], ...] = (
    ("announce", "broadcast"),
    ("announce", "unicast"),
    ("split", "unicast"),
)


def arrangement(how: Conditions) -> str:
    """Name how robots coordinate and send."""
    return f"{how.coordination}, {how.transport}"


@dataclass(frozen=True, slots=True)
class Extent:
    """How much is flown: so many seeds, seconds, robots, iterations; scenarios by their places; limits; and so on.

    `many` seeds where latencies are compared: there single missions differ by more than is asked.
    """

    seeds: int = 2
    many: int = 4
    seconds: float = 45.0
    robots: int = 10
    iterations: int = 300
    scenarios: tuple[int, ...] = (0, 1, 2)
    limits: tuple[int, ...] = (2, 5, 10)
    usual: int = 5
    latencies: tuple[float, ...] = (0.3, FAR)
    losses: tuple[float, ...] = (0.0, 0.1, 0.3)

    def conditions(self) -> Conditions:
        """Return the usual conditions."""
        return Conditions(
            limit=self.usual,
            latency=LATENCY,
            loss=LOSS,
            seconds=self.seconds,
            robots=self.robots,
            iterations=self.iterations,
        )


QUICK = Extent(
    seeds=1,
    many=1,
    seconds=3.0,
    robots=3,
    iterations=50,
    scenarios=(1,),
    limits=(2,),
    usual=2,
    latencies=(FAR,),
    losses=(0.3,),
)


def programme(extent: Extent) -> dict[str, list[Flight]]:
    """Return all flights by what they are flown for."""
    usual = extent.conditions()
    right = replace(usual, loss=0.0)
    return {
        "limits": _flights(extent, *(replace(usual, limit=limit) for limit in extent.limits)),
        "usual": _flights(extent, usual, seeds=extent.many),
        "inside": _flights(extent, replace(usual, digests_inside=True)),
        "latency": _flights(extent, *(replace(usual, latency=t) for t in extent.latencies), seeds=extent.many),
        "known clocks": _flights(extent, replace(usual, latency=FAR, clock_error=CLOCK_ERROR), seeds=extent.many),
        "loss": _flights(extent, *(replace(usual, loss=loss) for loss in extent.losses)),
        "forecasts": list(_forecasts(extent)),
        "right clocks": _flights(extent, right, seeds=1),
        **{name: _flights(extent, replace(right, clocks=c), seeds=1) for name, c in wrong_clocks(extent).items()},
        "churn": _flights(extent, replace(usual, happenings=churn(extent))),
    }


def wrong_clocks(extent: Extent) -> dict[str, dict[str, Clock]]:
    """Return by name what is wrong with the clocks of every robot."""
    robots = [f"r{i}" for i in range(extent.robots)]
    middle = WARM_UP + extent.seconds / 2.0
    return {
        f"clocks ±{SKEW:g} s apart, drift ±50 ppm": {
            robot: Clock(offset=sign * SKEW, drift=sign * 50.0, wall=sign * SKEW)
            for i, robot in enumerate(robots)
            for sign in ((-1) ** i,)
        },
        f"wall clocks step by ±{STEP:g} s": {
            robot: Clock(steps=((middle + 0.1 * i, STEP * (-1) ** i),)) for i, robot in enumerate(robots)
        },
        "no time at boot": {robot: booted_without_time(middle if i % 2 else 1e6) for i, robot in enumerate(robots)},
    }


def churn(extent: Extent) -> tuple[Join | Leave | Crash, ...]:
    """Return who comes and goes: one crashes and comes again, one leaves, one joins late."""
    part = WARM_UP, extent.seconds / 5.0
    return (
        Crash(part[0] + part[1], "r1"),
        Join(part[0] + 2.0 * part[1], "r1"),
        Leave(part[0] + 3.0 * part[1], "r2"),
        Join(part[0] + 4.0 * part[1], "r2"),
    )


def _flights(extent: Extent, *conditions: Conditions, seeds: int = 0) -> list[Flight]:
    """Return a flight of every scenario, seed and arrangement under each of these conditions."""
    courses = [Course(scenario, seed) for scenario, seed in product(extent.scenarios, range(seeds or extent.seeds))]
    return [
        Flight(course, replace(how, coordination=coordination, transport=transport))
        for how, course, (coordination, transport) in product(conditions, courses, ARRANGEMENTS)
    ]


def _forecasts(extent: Extent) -> Iterator[Flight]:
    for loss, seed, (coordination, transport) in product(extent.losses, range(extent.seeds), ARRANGEMENTS):
        how = replace(extent.conditions(), loss=loss, coordination=coordination, transport=transport)
        yield Flight(Course(1, seed, JITTER), how)
