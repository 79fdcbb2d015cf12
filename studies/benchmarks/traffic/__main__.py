"""Flies some cases: `python -m studies.benchmarks.traffic --robots 1 2 --seconds 20 -- --planner.horizon 120`.

What follows "--" are flags of every daemon. One line for each flight goes to standard error, the tables to standard
output or to the page that `--output` names.
"""

import argparse
import sys
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from studies.benchmarks.report import machine, write_page
from studies.benchmarks.traffic.measure import Case, results, tables


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly, and tell what was found."""
    options = _parser().parse_args(arguments)
    cases = [
        Case(robots, limit, frame) for robots in options.robots for limit in options.limit for frame in options.frame
    ]
    found = list(results(cases, options.seconds, options.time_limit, options.seed, options.flags))
    pages = tables(found, options.seconds)
    print(machine())
    for page in pages:
        print(f"\n{page.text()}")
    if options.output:
        command = f"python -m studies.benchmarks.traffic {' '.join(arguments or sys.argv[1:])}"
        write_page(options.output, "Real daemons, real traffic", pages, datetime.now(UTC), command)
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m studies.benchmarks.traffic",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--robots", type=int, nargs="+", default=[2], help="how many (default: 2)")
    parser.add_argument("--limit", type=float, nargs="+", default=[1e6], help="of the spec [bit/s] (default: 1e6)")
    parser.add_argument("--frame", type=int, nargs="+", default=[26_000], help="mean size [B] (default: 26000)")
    parser.add_argument("--seconds", type=float, default=30.0, help="length of each flight (default: 30)")
    parser.add_argument("--seed", type=int, default=1, help="of what is published (default: 1)")
    parser.add_argument("--time-limit", type=float, default=60.0, help="for the best plan [s] (default: 60)")
    parser.add_argument("--output", type=Path, help="file of a page with the tables")
    parser.add_argument("flags", nargs="*", help="of every daemon")
    return parser


if __name__ == "__main__":
    sys.exit(main())
