"""Robots that start, die and come back, and teams that part and merge, in real traffic: `python -m ….traffic.churn`.

The last robot joins late, dies without a word and comes back with a new id; later half of the team loses the operator
and the other half, and both meet again. What counts is how soon a robot sends once it has links, how long anybody who
has is silent, and for how long a team that has merged exceeds the limit.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from planner.utility import Floats
from studies.simulation.churn import Crash, Happening, Join, Merge, Partition
from studies.simulation.membership import LIVELINESS
from studies.simulation.missions import OPERATOR
from studies.simulation.traffic.comparison import Cell, how_of
from studies.simulation.traffic.flights import crew
from studies.simulation.traffic.missions import WARM_UP, Mission
from studies.simulation.traffic.scores import EXACT, Flight, held

JOINS, DIES, RETURNS, PARTS, MERGES, ENDS = 10.0, 16.0, 21.0, 27.0, 34.0, 42.0
"""When what happens [s]."""


@dataclass(frozen=True, slots=True)
class Turn:
    """What became of a flight.

    `first` are the times from a robot's links to its first sample, for each that starts [s]; infinite where none came.
    `silence` is by robot the longest time without a sample while the operator was linked, `over` for how long after
    the merge windows exceeded the limit [s], and `share` the part of samples before the parting whose windows did.
    """

    first: tuple[float, ...]
    silence: dict[str, float]
    over: float
    share: float


def happenings(robots: Sequence[str]) -> tuple[Happening, ...]:
    """Return what happens to a team of these robots and an operator."""
    last, half = robots[-1], len(robots) // 2
    groups = frozenset({OPERATOR, *robots[:half]}), frozenset(robots[half:])
    return Join(JOINS, last), Crash(DIES, last), Join(RETURNS, last), Partition(PARTS, groups), Merge(MERGES)


def linked(robots: Sequence[str], latency: float) -> dict[str, list[tuple[float, float]]]:
    """Return from when to when each robot has a link to the operator and knows it [s]."""
    last, half, noticed = robots[-1], len(robots) // 2, latency + LIVELINESS
    again = MERGES + noticed
    spans = {robot: [(WARM_UP, ENDS)] for robot in robots[:half]}
    spans |= {robot: [(WARM_UP, PARTS), (again, ENDS)] for robot in robots[half:]}
    spans[last] = [(JOINS + noticed, DIES), (RETURNS + noticed, PARTS), (again, ENDS)]
    return spans


def judge(mission: Mission, flight: Flight, latency: float) -> Turn:
    """Say what became of a flight with these happenings."""
    robots = mission.robots
    sends = {
        robot: np.array([air.t for air in flight.on_air if air.robot == robot and air.frame is not None])
        for robot in robots
    }
    spans = linked(robots, latency)
    ends, full = held(mission, flight.on_air)
    over = full > mission.limit * (1 + EXACT)
    merged, whole = ends[over & (ends >= MERGES)], (ends >= WARM_UP) & (ends < PARTS)
    return Turn(
        tuple(_first(sends[robots[-1]], begin) for begin, _ in spans[robots[-1]][:2]),
        {robot: max(_silence(sends[robot], *span) for span in spans[robot]) for robot in robots},
        float(merged.max() - MERGES) if len(merged) else 0.0,
        float(over[whole].mean()) if whole.any() else 0.0,
    )


def fly(cell: Cell, contender: str) -> Turn:
    """Let a team fly a cell's mission with these happenings."""
    how = how_of(cell, contender)
    mission = cell.mission(everybody=how.broadcasts)
    ready = crew(mission, how, cell.seed, happenings(mission.robots))
    ready.run(mission.frames, ENDS)
    return judge(mission, ready, cell.latency)


def line(cell: Cell, contender: str, turn: Turn) -> str:
    """Return the figures of one flight."""
    first = ", ".join(f"{1000 * each:.0f} ms" for each in turn.first)
    silence = ", ".join(f"{robot} {each:.1f} s" for robot, each in turn.silence.items())
    return (
        f"{cell.label} seed {cell.seed} {contender} | first sample {first} after the links | "
        f"silent at most {silence} | over for {turn.over:.2f} s after the merge, else {100 * turn.share:.1f} %"
    )


def _first(sends: Floats, begin: float) -> float:
    later = sends[sends >= begin]
    return float(later[0] - begin) if len(later) else float("inf")


def _silence(sends: Floats, begin: float, end: float) -> float:
    within = sends[(sends >= begin) & (sends <= end)]
    return float(np.diff([begin, *within, end]).max())


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly the teams asked for, and print what became of each."""
    parser = argparse.ArgumentParser(prog="python -m studies.simulation.traffic.churn", description=__doc__)
    add = parser.add_argument
    add("--workload", choices=("mixed", "random", "cameras"), default="mixed")
    add("--robots", type=int, default=4)
    add("--teams", nargs="+", default=("announce/unicast", "announce/broadcast"), help="as in the comparison")
    add("--latencies", nargs="+", type=float, default=[0.02], help="[s]")
    add("--losses", nargs="+", type=float, default=[0.01])
    add("--seeds", type=int, default=1)
    options = parser.parse_args(arguments)
    for latency in options.latencies:
        for loss in options.losses:
            for seed in range(options.seeds):
                cell = Cell(options.workload, options.robots, latency, loss, seed, ENDS - WARM_UP)
                for team in options.teams:
                    print(line(cell, team, fly(cell, team)), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
