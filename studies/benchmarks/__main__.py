"""The command: `python -m studies.benchmarks [speed] [quality] [grid] [designs] [--quick] [--output DIR]`."""

import argparse
import sys
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path

from studies.benchmarks.designs import measure_designs
from studies.benchmarks.grid import measure_grid
from studies.benchmarks.quality import measure_quality
from studies.benchmarks.report import Table, machine, write_page
from studies.benchmarks.speed import measure_speed
from studies.oracle import OracleUnavailable

RESULTS = Path(__file__).parent.parent / "results"

BENCHMARKS: dict[str, tuple[str, Callable[[bool], list[Table]]]] = {
    "speed": ("Speed of the planner", lambda quick: measure_speed(quick=quick)),
    "quality": ("Quality of the planner's decisions", lambda quick: measure_quality(quick=quick)),
    "grid": ("What missions reach, from tight limits to loose", lambda quick: measure_grid(quick=quick)),
    "designs": ("What designs of the search lose", lambda quick: measure_designs(quick=quick)),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the benchmarks, print their tables and write them; return 1 when one could not run."""
    options = _parser().parse_args(arguments)
    pages = options.output or (None if options.quick else RESULTS)
    failed = False
    print(machine(), flush=True)
    for name in options.benchmarks or BENCHMARKS:
        title, measure = BENCHMARKS[name]
        try:
            tables = measure(options.quick)
        except OracleUnavailable as error:
            print(f"{name}: {error}", file=sys.stderr)
            failed = True
            continue
        for table in tables:
            print(f"\n{table.text()}", flush=True)
        if pages:
            write_page(pages / f"{name}.md", title, tables, datetime.now(UTC))
    return int(failed)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m studies.benchmarks", description=__doc__)
    known = ", ".join(BENCHMARKS)
    parser.add_argument("benchmarks", nargs="*", type=_known, metavar="BENCHMARK", help=f"of {known}; all by default")
    parser.add_argument("--quick", action="store_true", help="a few seconds, rough figures")
    parser.add_argument("--output", type=Path, help="folder of the pages; studies/results, or none when --quick")
    return parser


def _known(name: str) -> str:
    if name not in BENCHMARKS:
        raise argparse.ArgumentTypeError(f"{name!r} is not one of {', '.join(BENCHMARKS)}")
    return name


if __name__ == "__main__":
    sys.exit(main())
