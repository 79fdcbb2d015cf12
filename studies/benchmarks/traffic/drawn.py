"""Real daemons on workloads that nobody chose: `python -m studies.benchmarks.traffic.drawn --seeds 120`.

What is drawn is what `studies.simulation.traffic.drawn` flies in simulation, with `--unequal` as there, but always over
unicast and without loss. `--robots` leaves out teams that are too large for the machine: where one is, applications
publish late. One line for each flight goes to standard error, tables and last line to standard output, and the tables
to the page that `--output` names. What follows "--" are flags of every daemon.
"""

import argparse
import math
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from statistics import fmean

import numpy as np

from studies.benchmarks.report import Table, machine, write_page
from studies.benchmarks.traffic.agenda import draw
from studies.benchmarks.traffic.figures import Best, Figures, Worth, best, figures, reached
from studies.benchmarks.traffic.flight import fly
from studies.simulation.traffic.drawn import ROBOTS, Drawn, drawn_by, first_seed

COLUMNS = (
    "workload",
    "utility of the best",
    "gap",
    "bytes of the best",
    "windows over",
    "fullest",
    "10 s",
    "robot [ms/sample]",
    "late p99 [ms]",
)
UNEQUAL = ", of teams whose robots have kinds of their own (`of`: so many have one), with streams that pause"


@dataclass(frozen=True, slots=True)
class Result:
    """The figures of a flight, and the best that could have been."""

    drawn: Drawn
    figures: Figures
    worth: Worth
    best: Best

    @property
    def part(self) -> float:
        """What was reached of the best."""
        return self.worth.everything / self.best.worth.everything


def drawn_for(seeds: Sequence[int], robots: int, *, unequal: bool = False) -> list[Drawn]:
    """Draw workloads, but for larger teams than so many `robots` and where nothing is disputed."""
    drawn = [drawn_by(seed, unequal=unequal) for seed in seeds]
    return [each for each in drawn if each.disputed and len(each.workload.robots) <= robots]


def results(
    workloads: Sequence[Drawn], seconds: float, time_limit: float, flags: Sequence[str] = ()
) -> Iterator[Result]:
    """Fly workloads for so long [s]; the search for the best takes `time_limit` [s]."""
    for drawn in workloads:
        workload = drawn.workload
        flight = fly(draw(workload, seconds, drawn.seed), workload.spec(), flags=flags)
        of, worth = figures(flight, workload), reached(flight, workload)
        found = Result(drawn, of, worth, best(flight, workload, time_limit))
        print("; ".join(map(" ".join, zip(COLUMNS, _row(found), strict=True))), file=sys.stderr, flush=True)
        yield found


def tables(found: Sequence[Result], seconds: float) -> list[Table]:
    """Return how much was reached in all, and each flight, the worst first."""
    parts = np.array([each.part for each in found])
    shares = [f"{np.quantile(parts, quantile):.1%}" for quantile in (0.0, 0.1, 0.25, 0.5)]
    over = [each.figures.over for each in found]
    summary = (*shares, f"{np.mean(over):.1%}", f"{max(each.figures.worst for each in found):.0%}")
    unequal = UNEQUAL if any(each.drawn.unequal for each in found) else ""
    note = (
        f"{len(found)} workloads, flights of {seconds:g} s over unicast{unequal}. Of the best: the plan of whole"
        " messages with most utility, known offline; `gap`: what it lacks of what no plan can exceed. Windows of all"
        " sends, digests included, as they crossed the links; 10 s: the fullest, of what the limit allows then. Late:"
        " by how much applications published later than due, which is the machine's doing. Sizes in limits."
    )
    return [
        Table(
            "Utility, of the best plan's", ("least", "10 %", "25 %", "median", "windows over", "fullest"), (summary,)
        ),
        Table("Each", COLUMNS, tuple(map(_row, sorted(found, key=lambda each: each.part))), note),
    ]


def last_line(found: Sequence[Result]) -> str:
    """Return what came of all in one line."""
    parts, over = [each.part for each in found], fmean(each.figures.over for each in found)
    return (
        f"{len(found)} flights, {np.median(parts):.1%} of the best plan ({min(parts):.1%} at least), {over:.1%} of"
        f" windows over, fullest 10 s {max(each.figures.sustained for each in found):.0%}"
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly, and tell what was found."""
    parser = _parser()
    options = parser.parse_args(arguments)
    seeds = range(options.first, options.first + options.seeds)
    workloads = drawn_for(seeds, options.robots, unequal=options.unequal)
    if not workloads:
        parser.error("none of these seeds draws a team of so few robots that has something to dispute")
    found = list(results(workloads, options.seconds, options.time_limit, options.flags))
    pages = tables(found, options.seconds)
    print(machine())
    for page in pages:
        print(f"\n{page.text()}")
    print(f"\n{last_line(found)}")
    if options.output:
        write_page(options.output, "Real daemons on drawn workloads", pages, datetime.now(UTC), _command(options))
    return int(max(each.figures.sustained for each in found) > options.at_most)


def _command(options: argparse.Namespace) -> str:
    """Return the command that flies the same again."""
    return (
        f"python -m studies.benchmarks.traffic.drawn --first {options.first} --seeds {options.seeds}"
        f" --robots {options.robots} --seconds {options.seconds:g} --time-limit {options.time_limit:g}"
        f"{' --unequal' if options.unequal else ''}"
    )


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m studies.benchmarks.traffic.drawn",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("--first", type=int, default=first_seed(datetime.now(UTC).date()), help="first seed (default: by the day)")
    add("--seeds", type=int, default=120, help="so many of them are drawn (default: 120)")
    add("--robots", type=int, default=max(ROBOTS), help=f"teams of so many at most (default: {max(ROBOTS)}, all)")
    add("--unequal", action="store_true", help="teams whose robots have kinds of their own")
    add("--seconds", type=float, default=25.0, help="length of each flight (default: 25)")
    add("--time-limit", type=float, default=20.0, help="for the best plan [s] (default: 20)")
    add("--at-most", type=float, default=math.inf, help="fail where 10 s hold more than so many times the limit")
    add("--output", type=Path, help="file of a page with the tables")
    add("flags", nargs="*", help="of every daemon")
    return parser


def _row(found: Result) -> tuple[str, ...]:
    of = found.figures
    return (
        found.drawn.offer,
        f"{found.part:.1%}",
        f"{found.best.gap:.1%}",
        f"{of.sent / found.best.size:.0%}",
        f"{of.over:.1%}",
        f"{of.worst:.0%}",
        f"{of.sustained:.0%}",
        f"{1e3 * of.robots:.2f}",
        f"{1e3 * of.late:.1f}",
    )


if __name__ == "__main__":
    sys.exit(main())
