"""The command: `python -m studies.study`, the whole study; what it flew already it takes from its store."""

import argparse
import os
import sys
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from time import monotonic

from proxy.extras import needs, there
from studies.ns3.building import shim
from studies.ns3.errors import Ns3Unavailable
from studies.study.costs import plan
from studies.study.errors import StudyError
from studies.study.page import write
from studies.study.programme import EXTENTS, FULL, everything
from studies.study.results import Results
from studies.study.running import run
from studies.study.store import Store

STORE = Path("build/study/records.jsonl")
PAGE = Path("studies/RESULTS.md")
SAID = 5
"""So many flights that failed are named."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly what is missing and write the pages; return the exit code."""
    options = _parser().parse_args(arguments)
    extent = EXTENTS[options.extent]
    tasks = everything(extent)
    store = Store(options.store)
    missing = store.missing(tasks)
    print(f"The study, {extent.name}. {plan(missing, len(tasks) - len(missing), options.jobs)}", flush=True)
    if options.plan:
        return 0
    begin = monotonic()
    try:
        _check(here=bool(missing) and not options.dask)
        outcome = run(tasks, store, jobs=options.jobs, dask=options.dask)
    except StudyError as error:
        print(f"study: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print(f"study: interrupted; {len(store)} flights are kept in {options.store}, and it goes on from there")
        return 130
    print(f"flown {outcome.flown} in {monotonic() - begin:.0f} s", flush=True)
    for task, why in outcome.failed[:SAID]:
        print(f"study: {task}: {why}", file=sys.stderr)
    if outcome.failed:
        print(f"study: {len(outcome.failed)} flights failed; run it again to fly these alone", file=sys.stderr)
    write(Results(store), extent, options.page, datetime.now(UTC))
    print(f"{options.page}: written")
    return 1 if outcome.failed else 0


def _check(*, here: bool) -> None:
    """Raise StudyError for what would be missed after hours; where flights are flown here ns-3's shim is compiled."""
    if not (there("matplotlib") and there("scipy")):
        raise StudyError(f"a study, for its bound and its figures, {needs('study')}")
    if here:
        try:
            shim()
        except Ns3Unavailable as error:
            raise StudyError(str(error)) from None


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m studies.study", description=__doc__)
    add = parser.add_argument
    add("--extent", choices=tuple(EXTENTS), default=FULL.name, help="how much is flown (default: %(default)s)")
    add("--jobs", type=int, default=os.cpu_count() or 1, help="processes (default: as many as there are cores)")
    add("--dask", metavar="ADDRESS", default="", help="send the flights to this Dask cluster, such as tcp://host:8786")
    add("--store", type=Path, default=STORE, help="where results are kept (default: %(default)s)")
    add("--page", type=Path, default=PAGE, help="what is written; figures go to results/ beside it")
    add("--plan", action="store_true", help="say what would be flown and how long that takes, and end")
    return parser


if __name__ == "__main__":
    sys.exit(main())
