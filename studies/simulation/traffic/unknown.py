"""Real traffic on a channel that nobody knows: a limit that follows it, beside one that is right.

`python -m studies.simulation.traffic.unknown --output PAGE`

The medium carries what the workload's limit says, or a part of it, and no more: what is sent beyond it waits. Adaptive
limits were tuned on equal messages; flown so, with a ceiling of 50 times what the radio bears, four robots got nothing
through for good. Where a frame takes most of a second four sent next to nothing any more, for want of news.
"""

import argparse
import os
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from statistics import fmean

from studies.benchmarks.report import Table, write_page
from studies.processes import processes
from studies.simulation.missions import specs_of
from studies.simulation.traffic.flights import How, fly
from studies.simulation.traffic.missions import draw_from
from studies.simulation.traffic.scores import Score, score
from studies.simulation.traffic.workloads import WORKLOADS, Workload
from utility_specs import Specs
from utility_specs.constraint_tables import FLOOR

TEAMS = (
    ("mixed", 2, 1.0),
    ("mixed", 4, 1.0),
    ("cameras", 4, 1.0),
    ("random", 5, 1.0),
    ("mixed", 2, 0.3),
    ("mixed", 4, 0.3),
)
"""Workloads, robots, and what the radio carries as a part of what the workload's limit says."""
CEILINGS = (2.0, 6.0, 50.0)
"""In what the radio carries: who writes one takes the best that it can do."""
RIGHT = 0.95
"""A limit that is right, as a part of what the radio carries."""
LATENCY, LOSS = 0.01, 0.01
"""Beside what waits [s], and part of what is sent."""
Row = tuple[str, ...]
COLUMNS = ("team", "ceiling", "utility of the right limit's", "small sent", "age p50, p95 [ms]", "alarms", "told [B/s]")


@dataclass(frozen=True, slots=True)
class Flight:
    """A team with a workload, and its limit: a ceiling in what the radio carries, or 0 for the right one.

    The radio carries a `part` of what the workload's limit says.
    """

    workload: str
    robots: int
    part: float
    ceiling: float
    seed: int
    seconds: float

    def fly(self) -> Score:
        """Return what comes of it."""
        workload = WORKLOADS[self.workload](self.robots)
        workload = replace(workload, rate=self.part * workload.rate)
        mission = draw_from(workload, self.seed, self.seconds, latency=LATENCY)
        mission = replace(mission, specs=under(workload, self.ceiling))
        how = How(latency=LATENCY, loss=LOSS, rate=workload.rate)
        return score(mission, fly(mission, how, self.seed), LOSS)


def under(workload: Workload, ceiling: float) -> Specs:
    """Return the specs of a workload under a limit with such a ceiling; under the right one, if that is 0.

    It has no floor but the usual one: to write a better one takes knowing the channel.
    """
    rate = workload.rate
    adaptive = f'"adaptive"\nceiling = "{ceiling * rate!r} B/s"'
    limit = adaptive if ceiling else f'"{RIGHT * rate!r} B/s"'
    return specs_of(workload.spec().replace(f'"{rate!r} B/s"', limit, 1))


def rows(seeds: Sequence[int], seconds: float, jobs: int) -> Iterator[Row]:
    """Fly all teams under all limits; yield a row for each, the right limit's first."""
    limits = (0.0, *CEILINGS)
    flights = [Flight(*team, limit, seed, seconds) for team in TEAMS for limit in limits for seed in seeds]
    with processes(jobs) as pool:
        scores = pool.map(Flight.fly, flights)
        for name, robots, part in TEAMS:
            right: list[Score] = []
            for limit in limits:
                found = [next(scores) for _ in seeds]
                right = right or found
                radio = "" if part == 1.0 else f", {part:g} of the rate"
                yield _row(f"{name}, {robots} robots{radio}", limit, found, right)


def _row(team: str, ceiling: float, found: Sequence[Score], right: Sequence[Score]) -> Row:
    part = fmean(one.utility / other.utility for one, other in zip(found, right, strict=True))
    small = found[0].has_small
    ages = (1e3 * fmean(each.age[k] for each in found) for k in (0, 1))
    alarms = [sum(counts) for counts in zip(*((each.alarms_sent, each.alarms) for each in found), strict=True)]
    return (
        team,
        f"{ceiling:g} times" if ceiling else "right",
        f"{part:.1%}",
        f"{fmean(each.kept for each in found):.1%}" if small else "–",
        ", ".join(f"{age:.0f}" for age in ages) if small else "–",
        f"{alarms[0]}/{alarms[1]}" if alarms[1] else "–",
        f"{fmean(each.told for each in found):.0f}",
    )


def table(found: Sequence[Row], seeds: int, seconds: float) -> Table:
    """Return the table of the page."""
    note = (
        f"{seeds} flights of {seconds:g} s for each row, the first 5 s not scored; {LATENCY * 1e3:g} ms, {LOSS:.0%}"
        " lost. The radio carries the rate that the workload's limit says, or a part of it, and what is sent beyond it"
        " waits."
        f" Ceilings in what it carries, with the usual floor, {FLOOR:.1%} of them; right: a fixed limit of {RIGHT:g} of"
        " it. Small: of samples of 400 B at most, so many were sent, and so old they arrived."
    )
    return Table("Limits that follow the channel, on real traffic", COLUMNS, tuple(found), note)


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly, print each row, and write the page if a file is named."""
    options = _parser().parse_args(arguments)
    found: list[Row] = []
    for row in rows(range(options.seeds), options.seconds, options.jobs):
        found.append(row)
        print("; ".join(map(" ".join, zip(COLUMNS, row, strict=True))), flush=True)
    if options.output:
        command = f"python -m studies.simulation.traffic.unknown --seeds {options.seeds} --seconds {options.seconds:g}"
        pages = [table(found, options.seeds, options.seconds)]
        write_page(options.output, "A channel that nobody knows", pages, datetime.now(UTC), command)
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m studies.simulation.traffic.unknown",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("--seeds", type=int, default=3, help="flights for each row (default: 3)")
    add("--seconds", type=float, default=30.0, help="of a flight, 5 s of warm-up included (default: 30)")
    add("--jobs", type=int, default=os.cpu_count() or 1, help="processes (default: one for each core)")
    add("--output", type=Path, help="write the table there, as a Markdown page")
    return parser


if __name__ == "__main__":
    sys.exit(main())
