"""The command: `python -m studies.qualification [STAGE ...]`: hours of runs, and a dated page of what came of them.

Stages may be run one by one: the page shows how each ended when it last ran here, and of which version.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

from studies.benchmarks.report import Table, machine, write_page
from studies.qualification.stages import STAGES, Stage

ROOT = Path(__file__).parent.parent.parent
LONGEST = 100
"""Letters of a line that a stage printed, as the page has it."""
PAGE = ROOT / "studies" / "results" / "qualification.md"
LOGS = ROOT / "build" / "qualify"


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a stage ended: its exit code, how long it took [s], and the last line that it printed.

    It began at `date`, and ran `version`, which ends in a plus where files were changed since that commit.
    """

    code: int
    seconds: float
    last: str
    date: str
    version: str


def main(
    arguments: Sequence[str] | None = None, stages: Sequence[Stage] = STAGES, page: Path = PAGE, logs: Path = LOGS
) -> int:
    """Run the stages, all unless some are named, and write the page. Return 1 when one failed."""
    parser = argparse.ArgumentParser(prog="python -m studies.qualification", description=__doc__)
    names = [stage.name for stage in stages]
    parser.add_argument("stages", nargs="*", metavar="STAGE", help=f"of {', '.join(names)}; all by default")
    parser.add_argument("--page", action="store_true", help="run nothing, and write the page of what ran here before")
    parser.add_argument("--note", metavar="TEXT", default="", help="what the page says below, such as what else ran")
    given = parser.parse_args(arguments)
    asked = given.stages or ([] if given.page else names)
    if unknown := set(asked) - set(names):
        parser.error(f"{min(unknown)!r} is not one of {', '.join(names)}")
    print(machine(), flush=True)
    logs.mkdir(parents=True, exist_ok=True)
    failed = [stage.name for stage in stages if stage.name in asked and _run(stage, logs).code]
    write_page(page, "The long runs", [_table(stages, logs, given.note)], datetime.now(UTC), parser.prog)
    return int(bool(failed))


def _run(stage: Stage, logs: Path) -> Outcome:
    log, began = logs / f"{stage.name}.log", time.monotonic()
    date, version = f"{datetime.now(UTC):%Y-%m-%d %H:%M}", _version()
    with log.open("w") as written:
        environment = os.environ | dict(stage.environment)
        environment["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{environment['PATH']}"
        code = subprocess.run(
            stage.command, cwd=ROOT, env=environment, stdout=written, stderr=subprocess.STDOUT, check=False
        ).returncode
    lines = [line.strip("= ") for line in log.read_text(errors="replace").splitlines() if line.strip("= ")]
    outcome = Outcome(code, time.monotonic() - began, lines[-1] if lines else "", date, version)
    log.with_suffix(".json").write_text(json.dumps(asdict(outcome)))
    ended = f"failed, see {log}" if code else "passed"
    print(f"{stage.name}: {ended}, {outcome.seconds:.0f} s: {outcome.last}", flush=True)
    return outcome


def _version() -> str:
    """Return the commit that is run, with a plus if more than results was changed since; empty without a history."""
    asked = ("git", "rev-parse", "--short", "HEAD"), ("git", "status", "--porcelain", ".", f":(exclude){PAGE.parent}")
    commit, changed = (
        subprocess.run(git, cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip() for git in asked
    )
    return f"{commit}+" if changed else commit


def _table(stages: Sequence[Stage], logs: Path, note: str) -> Table:
    columns = ("what", "passed", "began (UTC)", "version", "took", "it said at last")
    rows = tuple((stage.shows, *_cells(logs / f"{stage.name}.json")) for stage in stages)
    return Table("Stages", columns, rows, note)


def _cells(kept: Path) -> tuple[str, ...]:
    if not kept.exists():
        return "not run", "", "", "", ""
    outcome = Outcome(**json.loads(kept.read_text()))
    return (
        "no" if outcome.code else "yes",
        outcome.date,
        outcome.version,
        f"{outcome.seconds:.0f} s",
        _short(outcome.last),
    )


def _short(line: str) -> str:
    """Return the first sentence of a line, or as much of it as has room."""
    sentence = re.split(r"[.:;] ", line, maxsplit=1)[0]
    return sentence if len(sentence) <= LONGEST else f"{sentence[: LONGEST - 1]}…"


if __name__ == "__main__":
    sys.exit(main())
