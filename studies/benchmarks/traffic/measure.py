"""Flies every case, each beside the same small streams through daemons that only pass things on."""

import os
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from proxy.profiling.profile import Profile
from proxy.profiling.stages import STAGES
from studies.benchmarks.report import Table
from studies.benchmarks.traffic.agenda import draw
from studies.benchmarks.traffic.figures import Ages, Best, Figures, Worth, best, figures, reached
from studies.benchmarks.traffic.flight import fly
from studies.demo.layout import OPERATOR
from studies.simulation.traffic.workloads import MBIT, Workload, mixed

BESIDE = 10.0
"""How long the small streams are flown alone [s]."""


@dataclass(frozen=True, slots=True)
class Case:
    """So many robots with the traffic *mixed*, a limit [bit/s], and frames of a mean size [B]."""

    robots: int = 2
    limit: float = 1e6
    frame: int = 26_000

    @property
    def name(self) -> str:
        """How tables call it."""
        return f"{self.robots}, {self.limit / 1e6:g} Mbit/s, {self.frame / 1000:g} kB"

    @property
    def workload(self) -> Workload:
        """What is flown."""
        flown = mixed(self.robots)
        robots = tuple(
            tuple(kind if kind.small else replace(kind, sizes=(self.frame, self.frame)) for kind in kinds)
            for kinds in flown.robots
        )
        return replace(flown, robots=robots, rate=self.limit / 1e6 * MBIT)


CASES = (
    *(Case(robots) for robots in (1, 2, 4, 8)),
    *(Case(limit=limit) for limit in (0.5e6, 3e6)),
    *(Case(frame=frame) for frame in (8_000, 60_000)),
)


@dataclass(frozen=True, slots=True)
class Result:
    """The figures of a case, `alone` those of its small streams where all passes, and the best that could have been."""

    case: Case
    figures: Figures
    alone: Ages
    worth: Worth
    best: Best
    profile: Profile | None
    load: tuple[float, float]


def measure_traffic(*, quick: bool) -> list[Table]:
    """Fly every case; `quick` flies two of them for seconds."""
    cases, seconds, time_limit = (CASES[:2], 8.0, 5.0) if quick else (CASES, 30.0, 120.0)
    return tables(list(results(cases, seconds, time_limit)), seconds)


def results(
    cases: Sequence[Case], seconds: float, time_limit: float, seed: int = 1, flags: Sequence[str] = ()
) -> Iterator[Result]:
    """Fly cases for so long [s], their daemons with further `flags`; the search for the best takes `time_limit` [s]."""
    for case in cases:
        workload = case.workload
        spec = workload.spec()
        large = {kind.name for kind in workload.kinds if not kind.small}
        alone = fly(draw(workload, min(seconds, BESIDE), seed, large), spec, mode="pass")
        flight = fly(draw(workload, seconds, seed), spec, flags=flags)
        found = Result(
            case,
            figures(flight, workload),
            figures(alone, workload).small,
            reached(flight, workload),
            best(flight, workload, time_limit),
            flight.profile,
            flight.load,
        )
        print(line(found), file=sys.stderr, flush=True)
        yield found


def line(found: Result) -> str:
    """Return a result in one line."""
    (_, *cells), (_, *columns) = _row(found), COLUMNS
    (_, *costs), (_, *names) = _cost(found), COSTS
    parts = [f"{column} {cell}" for column, cell in zip([*columns, *names], [*cells, *costs], strict=True)]
    return f"{found.case.name}: {'; '.join(parts)}"


def tables(found: Sequence[Result], seconds: float) -> list[Table]:
    """Return what was reached, what it cost, and where that was spent."""
    reached_note = (
        f"Traffic *mixed*: camera, odometry, telemetry, log and alarms of each robot; flights of {seconds:g} s. Of the"
        " best: the plan of whole messages with most utility that sends all small samples, known offline; `gap`: what"
        " it lacks of what no plan can exceed. Ages of small samples in ms, at their median and 95th percentile; alone:"
        " without cameras, in mode `pass`. Windows of all sends, digests included, as they crossed the links."
    )
    cost_note = (
        "Digests: what daemons tell each other, with Zenoh's framing of it. Processor time of a robot's daemon for a"
        " sample that its applications publish, of the operator's for one that comes. Late: by how much applications"
        f" published later than due, which is the machine's doing; it has {os.cpu_count()} cores, and its load counts"
        " all processes in the minute before and during the flight."
    )
    return [
        Table("What the operator got", COLUMNS, tuple(map(_row, found)), reached_note),
        Table("What it took", COSTS, tuple(map(_cost, found)), cost_note),
        Table("Where a robot's daemon spends it [ms/sample]", STAGED, tuple(map(_staged, found)), STAGED_NOTE),
    ]


COLUMNS = (
    "robots, limit, frames",
    "utility of the best",
    "without alarms",
    "gap",
    "bytes of the best",
    "small arrived",
    "age p50, p95",
    "alone",
    "odometry",
    "alarms",
    "camera",
    "windows over",
    "fullest",
)
COSTS = (
    "robots, limit, frames",
    "digests [B/s]",
    "framing [B/s]",
    "robot [ms/sample]",
    "operator",
    "late p99 [ms]",
    "load",
)
STAGED = ("robots, limit, frames", *STAGES, "all")
STAGED_NOTE = "Of the first robot, as `sendworthy profile` tells it, for samples that its applications publish."


def _row(found: Result) -> tuple[str, ...]:
    of = found.figures
    alarms = of.kinds["alarm"]
    return (
        found.case.name,
        f"{found.worth.everything / found.best.worth.everything:.1%}",
        f"{found.worth.others / found.best.worth.others:.1%}",
        f"{found.best.gap:.2%}",
        f"{of.sent / found.best.size:.0%}",
        f"{of.small.share:.1%}",
        f"{1e3 * of.small.p50:.1f}, {1e3 * of.small.p95:.1f}",
        f"{1e3 * found.alone.p50:.1f}, {1e3 * found.alone.p95:.1f}",
        f"{of.kinds['odometry'].share:.0%}",
        f"{alarms.arrived}/{alarms.published}",
        f"{of.kinds['camera'].share:.0%}",
        f"{of.over:.1%}",
        f"{of.worst:.0%}",
    )


def _cost(found: Result) -> tuple[str, ...]:
    of = found.figures
    return (
        found.case.name,
        f"{of.told:.0f}",
        f"{of.framing:.0f}",
        f"{1e3 * of.robots:.2f}",
        f"{1e3 * of.processor[OPERATOR]:.2f}",
        f"{1e3 * of.late:.1f}",
        f"{found.load[0]:.1f}, {found.load[1]:.1f}",
    )


def _staged(found: Result) -> tuple[str, ...]:
    profile = found.profile
    each = list(profile.stages.values()) if profile else []
    samples = max(profile.samples.total, 1) if profile else 1
    return (found.case.name, *(f"{1e3 * spent / samples:.2f}" for spent in (*each, sum(each))))
