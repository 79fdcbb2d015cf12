"""`sendworthy replay`: drives the core of a recording once more."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from proxy import exit_codes
from proxy.recording.errors import RecordingError

if TYPE_CHECKING:
    from proxy.recording.reading import RecordingReader

DESCRIPTION = """\
Drives the daemon's core through what a recording holds, and says whether it decides the same: each plan, found by as
many iterations as then, and each command is compared. Files of one robot that follow each other are one recording.
"""
EXAMPLES = """\
examples:
  sendworthy replay recordings/r1-20260101T120000Z-0001.mcap
  sendworthy replay recordings/*.mcap

exit codes:
  0  all is as it was
  1  something differs, or cannot be read or replayed
"""
WITHOUT = 'sendworthy replay: it needs the extra "record": pip install "sendworthy[record]"'


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "replay",
        help="drive the core through a recording once more",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("files", metavar="FILE", nargs="+", type=Path, help="recordings (MCAP)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Replay each robot's recording; return the exit code."""
    try:
        from proxy.recording.reading import RecordingReader  # noqa: PLC0415 - an extra
        from studies.replay.same import lives  # noqa: PLC0415 - needs it, too
    except ImportError:
        print(WITHOUT, file=sys.stderr)
        return exit_codes.FAILED
    files, alike = [], True
    for path in arguments.files:
        try:
            files.append(RecordingReader(path))
        except RecordingError as error:
            print(f"sendworthy replay: {error}", file=sys.stderr)
            alike = False
    for life in lives(files):
        alike = _same(life) and alike
    return exit_codes.OK if alike else exit_codes.FAILED


def _same(life: "list[RecordingReader]") -> bool:
    """Replay one robot's life exactly and say what was found; whether all was the same."""
    from studies.replay.same import replayed  # noqa: PLC0415 - an extra

    try:
        found = replayed(life)
    except RecordingError as error:
        print(f"sendworthy replay: {life[0].path}: {error}", file=sys.stderr)
        return False
    for problem in (problem for file in life for problem in file.problems):
        print(f"sendworthy replay: {problem}", file=sys.stderr)
    what = f"{found.decisions:,} decisions and {found.commands:,} commands in {found.events:,} events"
    print(f"{life[0].start.robot}, {found.seconds:,.1f} s: {what}, {'all' if found.equal else 'not all'} equal")
    if found.difference:
        print(f"  {found.difference}")
    if found.ended:
        print(f"  what comes later is not replayed: {found.ended}")
    return found.equal
