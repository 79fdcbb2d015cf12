"""The exact replay on the command line: each robot's recording, and whether its core decides the same."""

import sys
from collections.abc import Sequence
from typing import TextIO

from proxy.printable import clean
from proxy.recording.errors import RecordingError
from proxy.recording.reading import RecordingReader
from studies.replay.same import Sameness, lives, stretches


def all_equal(files: Sequence[RecordingReader], output: TextIO, *, python: bool = False) -> bool:
    """Replay each robot's recording exactly and say there what was found; whether all was the same."""
    alike = [_same(life, output, python=python) for life in lives(files)]
    return all(alike)


def _same(life: list[RecordingReader], output: TextIO, *, python: bool) -> bool:
    """Replay one robot's life exactly and say what was found; whether all was the same."""
    equal = True
    try:
        for found in stretches(life, python=python):
            _tell(life[0].start.robot, found, output)
            equal = equal and found.equal
    except RecordingError as error:
        print(clean(f"sendworthy replay: {life[0].path}: {error}"), file=sys.stderr)
        equal = False
    for problem in (problem for file in life for problem in file.problems):
        print(clean(f"sendworthy replay: {problem}"), file=sys.stderr)
    return equal


def _tell(robot: str, found: Sameness, output: TextIO) -> None:
    """Say what was found in a stretch of a robot's life."""
    since = f" from event {found.first:,} on" if found.first else ""
    what = f"{found.decisions:,} decisions and {found.commands:,} commands in {found.events:,} events{since}"
    alike = "all" if found.equal else "not all"
    print(clean(f"{robot}, {found.seconds:,.1f} s: {what}, {alike} equal"), file=output)
    if found.difference:
        print(clean(f"  {found.difference}"), file=output)
    if found.ended:
        print(clean(f"  what comes later is not replayed, up to the next snapshot: {found.ended}"), file=output)
