"""The command: `python -m studies.qualification [STAGE ...]`: hours of runs, and a dated page of what came of them."""

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from studies.benchmarks.report import Table, machine, write_page
from studies.qualification.stages import STAGES, Stage

ROOT = Path(__file__).parent.parent.parent
PAGE = ROOT / "studies" / "results" / "qualification.md"
LOGS = ROOT / "build" / "qualify"


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a stage ended: its exit code, how long it took [s], and the last line that it printed."""

    stage: Stage
    code: int
    seconds: float
    last: str


def main(arguments: Sequence[str] | None = None, stages: Sequence[Stage] = STAGES, page: Path = PAGE) -> int:
    """Run the stages, all unless some are named; write the page when all were run. Return 1 when one failed."""
    parser = argparse.ArgumentParser(prog="python -m studies.qualification", description=__doc__)
    names = [stage.name for stage in stages]
    parser.add_argument("stages", nargs="*", metavar="STAGE", help=f"of {', '.join(names)}; all by default")
    asked = parser.parse_args(arguments).stages or names
    if unknown := set(asked) - set(names):
        parser.error(f"{min(unknown)!r} is not one of {', '.join(names)}")
    print(machine(), flush=True)
    outcomes = [_run(stage) for stage in stages if stage.name in asked]
    if asked == names:
        write_page(page, "The long runs", [_table(outcomes)], datetime.now(UTC), parser.prog)
    return int(any(outcome.code for outcome in outcomes))


def _run(stage: Stage) -> Outcome:
    LOGS.mkdir(parents=True, exist_ok=True)
    log, began = LOGS / f"{stage.name}.log", time.monotonic()
    with log.open("w") as written:
        environment = os.environ | dict(stage.environment)
        environment["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{environment['PATH']}"
        code = subprocess.run(
            stage.command, cwd=ROOT, env=environment, stdout=written, stderr=subprocess.STDOUT, check=False
        ).returncode
    lines = [line.strip("= ") for line in log.read_text(errors="replace").splitlines() if line.strip("= ")]
    outcome = Outcome(stage, code, time.monotonic() - began, lines[-1] if lines else "")
    print(f"{stage.name}: {'failed, see ' + str(log) if code else 'passed'}, {outcome.seconds:.0f} s: {outcome.last}")
    return outcome


def _table(outcomes: Sequence[Outcome]) -> Table:
    rows = tuple(
        (each.stage.shows, "no" if each.code else "yes", f"{each.seconds:.0f} s", each.last) for each in outcomes
    )
    return Table("Stages", ("what", "passed", "took", "it said at last"), rows)


if __name__ == "__main__":
    sys.exit(main())
