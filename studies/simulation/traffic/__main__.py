"""The command: `python -m studies.simulation.traffic`, one line of figures for each flight, and a page of tables.

A team is written COORDINATION/TRANSPORT[/SETTING=VALUE...], such as `announce/unicast/margin=0.1`: further settings are
those of the core. Without --workloads, --latencies or --losses the whole comparison is flown.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from studies.benchmarks.report import Table, write_page
from studies.simulation.traffic.comparison import (
    ALL_WAYS,
    ONE_WAY,
    PLAN,
    USUAL,
    YARDSTICKS,
    Cell,
    Result,
    expected,
    fly_all,
    grid,
    how_of,
    tasks,
)
from studies.simulation.traffic.marks import Marks
from studies.simulation.traffic.report import line, tables

TEAMS = ("announce/unicast", "announce/broadcast")


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly what is asked for; print each flight, and write the tables if a file is named."""
    options = _parser().parse_args(arguments)
    cells = [cell for cell in _cells(options) if not options.only or any(o in cell.label for o in options.only)]
    flights = tasks(cells, [*options.yardsticks, *options.teams])
    for flight in flights[: len(options.teams) + len(options.yardsticks)]:
        if flight.contender != PLAN:
            how_of(flight.cell, flight.contender)
    minutes = expected(flights) / 60
    print(f"{len(flights)} flights, about {minutes:.0f} min of one core, {options.jobs} at a time", flush=True)
    marks, results = Marks(), list[Result]()
    for result in fly_all(flights, options.jobs):
        marks.add(result)
        results.append(result)
        print(line(result, marks), flush=True)
        if options.output:
            _write(options.output, tables(results))
    return 0


def _write(path: Path, results: Sequence[Table]) -> None:
    write_page(path, "Real traffic in simulation", results, datetime.now(UTC), "python -m studies.simulation.traffic")


def _cells(options: argparse.Namespace) -> list[Cell]:
    if not (options.workloads or options.latencies or options.losses):
        return grid(options.seeds, options.seconds)
    return [
        Cell(workload, robots, latency, loss, seed, options.seconds)
        for workload, robots in options.workloads or (*ALL_WAYS, *ONE_WAY)
        for latency in options.latencies or USUAL[:1]
        for loss in options.losses or USUAL[1:]
        for seed in range(options.first, options.first + options.seeds)
    ]


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m studies.simulation.traffic",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("--workloads", nargs="+", type=_workload, metavar="NAME:ROBOTS", help="such as mixed:4 uniform-few:10")
    add("--latencies", nargs="+", type=float, help="[s]")
    add("--losses", nargs="+", type=float, help="probabilities")
    add("--teams", nargs="*", default=TEAMS, metavar="TEAM", help=f"default {' '.join(TEAMS)}")
    add("--yardsticks", nargs="*", default=YARDSTICKS, choices=(*YARDSTICKS, PLAN), help=f"all but {PLAN}")
    add("--only", nargs="+", help="flights whose lines begin with a label that holds one of these")
    add("--seconds", type=float, default=30.0, help="scored, after 5 s of warm-up")
    add("--first", type=int, default=0, help="first seed")
    add("--seeds", type=int, default=3)
    add("--jobs", type=int, default=os.cpu_count() or 1, help="processes")
    add("--output", type=Path, help="write the tables there, as a Markdown page")
    return parser


def _workload(text: str) -> tuple[str, int]:
    name, _, robots = text.partition(":")
    usual = dict((*ALL_WAYS, *ONE_WAY))
    if name not in usual:
        raise argparse.ArgumentTypeError(f"{name!r} is not one of {', '.join(usual)}")
    return name, int(robots) if robots else usual[name]


if __name__ == "__main__":
    sys.exit(main())
