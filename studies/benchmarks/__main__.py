"""The command: `python -m studies.benchmarks [BENCHMARK ...] [--quick] [--output DIR]`."""

import argparse
import sys
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path

from studies.benchmarks.bridge import measure_bridge
from studies.benchmarks.budget import measure_budget
from studies.benchmarks.deciding import measure_deciding
from studies.benchmarks.designs import measure_designs
from studies.benchmarks.foresight import measure_foresight
from studies.benchmarks.grid import measure_grid
from studies.benchmarks.iterations import measure_iterations
from studies.benchmarks.latency import measure_latency
from studies.benchmarks.memory import measure_memory
from studies.benchmarks.mixed import measure_mixed
from studies.benchmarks.paper_mode import measure_paper_mode
from studies.benchmarks.quality import measure_quality
from studies.benchmarks.receding import measure_receding
from studies.benchmarks.report import Result, Table, machine, write_page
from studies.benchmarks.small import measure_small
from studies.benchmarks.speed import measure_speed
from studies.benchmarks.traffic import measure_traffic
from studies.benchmarks.view import measure_view
from studies.benchmarks.watching import measure_watching
from studies.oracle import OracleUnavailable
from studies.surveillance.cores import CoresError

RESULTS = Path(__file__).parent.parent / "results"

Benchmark = Callable[[bool], Sequence[Result]]

BENCHMARKS: dict[str, tuple[str, Benchmark]] = {
    "speed": ("Speed of the planner", lambda quick: measure_speed(quick=quick)),
    "memory": ("Memory of the planner", lambda quick: measure_memory(quick=quick)),
    "quality": ("Quality of the planner's decisions", lambda quick: measure_quality(quick=quick)),
    "grid": ("What missions reach, from tight limits to loose", lambda quick: measure_grid(quick=quick)),
    "mixed": ("What missions of mixed sizes reach", lambda quick: measure_mixed(quick=quick)),
    "latency": ("What missions reach with latency", lambda quick: measure_latency(quick=quick)),
    "iterations": ("What more iterations give", lambda quick: measure_iterations(quick=quick)),
    "paper_mode": ("Paper mode beside the paper", lambda quick: measure_paper_mode(quick=quick)),
    "foresight": ("What forecasts that know the future are worth", lambda quick: measure_foresight(quick=quick)),
    "receding": ("Beside the exact receding-horizon optimiser", lambda quick: measure_receding(quick=quick)),
    "view": ("How right the shared view is, and what a team reaches with it", lambda quick: measure_view(quick=quick)),
    "bridge": ("What the bridge costs", lambda quick: measure_bridge(quick=quick)),
    "budget": ("What a daemon costs", lambda quick: measure_budget(quick=quick)),
    "deciding": ("How long decisions take", lambda quick: measure_deciding(quick=quick)),
    "watching": ("What it costs to watch a daemon", lambda quick: measure_watching(quick=quick)),
    "small": ("What a small computer makes of it", lambda quick: measure_small(quick=quick)),
    "daemons": ("Real daemons, real traffic", lambda quick: measure_traffic(quick=quick)),
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
            results = measure(options.quick)
        except (OracleUnavailable, CoresError) as error:
            print(f"{name}: {error}", file=sys.stderr)
            failed = True
            continue
        for result in results:
            if isinstance(result, Table):
                print(f"\n{result.text()}", flush=True)
        if pages:
            write_page(pages / f"{name}.md", title, results, datetime.now(UTC))
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
