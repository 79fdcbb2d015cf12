"""Real daemons on workloads that nobody chose: `python -m studies.benchmarks.traffic.drawn --seeds 120`.

What is drawn is what `studies.simulation.traffic.drawn` flies in simulation, as far as the teams are small enough for
one machine. One line for each flight goes to standard error, the table to standard output or to the page that
`--output` names. What follows "--" are flags of every daemon.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from studies.benchmarks.report import Table, machine, write_page
from studies.benchmarks.traffic.agenda import draw
from studies.benchmarks.traffic.figures import Best, Figures, Worth, best, figures, reached
from studies.benchmarks.traffic.flight import fly
from studies.simulation.traffic.drawn import Drawn, drawn_by, first_seed

COLUMNS = (
    "workload",
    "utility of the best",
    "gap",
    "bytes of the best",
    "windows over",
    "fullest",
    "robot [ms/sample]",
    "late p99 [ms]",
)


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


def results(
    seeds: Sequence[int], robots: int, seconds: float, time_limit: float, flags: Sequence[str] = ()
) -> Iterator[Result]:
    """Fly what seeds draw for so long [s], but for larger teams than so many `robots` and where nothing is disputed."""
    for drawn in map(drawn_by, seeds):
        if not drawn.disputed or len(drawn.workload.robots) > robots:
            continue
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
    note = (
        f"{len(found)} workloads, flights of {seconds:g} s over unicast. Of the best: the plan of whole messages with"
        " most utility, known offline; `gap`: what it lacks of what no plan can exceed. Windows of all sends, digests"
        " included, as they crossed the links. Late: by how much applications published later than due, which is the"
        " machine's doing. Sizes in limits."
    )
    return [
        Table(
            "Utility, of the best plan's", ("least", "10 %", "25 %", "median", "windows over", "fullest"), (summary,)
        ),
        Table("Each", COLUMNS, tuple(map(_row, sorted(found, key=lambda each: each.part))), note),
    ]


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly, and tell what was found."""
    parser = argparse.ArgumentParser(
        prog="python -m studies.benchmarks.traffic.drawn",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--first", type=int, default=first_seed(datetime.now(UTC).date()), help="first seed (default: by the day)"
    )
    parser.add_argument("--seeds", type=int, default=120, help="so many of them are drawn (default: 120)")
    parser.add_argument("--robots", type=int, default=4, help="teams of so many at most (default: 4)")
    parser.add_argument("--seconds", type=float, default=25.0, help="length of each flight (default: 25)")
    parser.add_argument("--time-limit", type=float, default=20.0, help="for the best plan [s] (default: 20)")
    parser.add_argument("--output", type=Path, help="file of a page with the tables")
    parser.add_argument("flags", nargs="*", help="of every daemon")
    options = parser.parse_args(arguments)
    seeds = range(options.first, options.first + options.seeds)
    found = list(results(seeds, options.robots, options.seconds, options.time_limit, options.flags))
    if not found:
        parser.error("none of these seeds draws a small team that has something to dispute")
    pages = tables(found, options.seconds)
    print(machine())
    for page in pages:
        print(f"\n{page.text()}")
    if options.output:
        command = (
            f"python -m studies.benchmarks.traffic.drawn --first {options.first} --seeds {options.seeds}"
            f" --robots {options.robots} --seconds {options.seconds:g} --time-limit {options.time_limit:g}"
        )
        write_page(options.output, "Real daemons on drawn workloads", pages, datetime.now(UTC), command)
    return 0


def _row(found: Result) -> tuple[str, ...]:
    of = found.figures
    return (
        found.drawn.offer,
        f"{found.part:.1%}",
        f"{found.best.gap:.1%}",
        f"{of.sent / found.best.size:.0%}",
        f"{of.over:.1%}",
        f"{of.worst:.0%}",
        f"{1e3 * of.robots:.2f}",
        f"{1e3 * of.late:.1f}",
    )


if __name__ == "__main__":
    sys.exit(main())
