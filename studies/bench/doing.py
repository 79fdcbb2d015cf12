"""What `sendworthy bench` does."""

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path

from proxy.output import check_writable
from studies.bench.errors import BenchError
from studies.bench.flying import BUILT_IN, Score
from studies.bench.folder import SUFFIX, find, load, write_sums
from studies.bench.format import text_of
from studies.bench.generated import GENERATED
from studies.bench.leaderboard import text, write_page
from studies.bench.running import fly_all

VERSION = 1
"""Of the JSON: what would be misread has a greater one."""


class RecordMissingError(Exception):
    """The extra that reads recordings is not installed."""


def bench(arguments: argparse.Namespace) -> None:
    """Do what was asked for. Raises BenchError, OracleError, SpecsError, OSError or RecordMissingError."""
    if arguments.generate is not None:
        generate(arguments.generate)
    elif arguments.make is not None or arguments.recording is not None:
        _make(arguments)
    elif arguments.list:
        _list()
    else:
        _fly(arguments)


def generate(folder: Path) -> None:
    """Write all missions that are drawn, and the checksums of all that are in the folder then."""
    folder.mkdir(parents=True, exist_ok=True)
    for drawn in GENERATED:
        path = folder / f"{drawn.name}{SUFFIX}"
        path.write_text(text_of(drawn.mission()), encoding="utf-8")
        _say(f"{path}: written")
    write_sums(folder)


def _make(arguments: argparse.Namespace) -> None:
    if arguments.make is None or not arguments.recording:
        raise BenchError("--make FILE and --recording FILE go together: what is written, and of what")
    if arguments.make.suffix != SUFFIX:
        raise BenchError(f"{arguments.make}: the file of a mission ends in {SUFFIX}")
    check_writable([arguments.make])
    try:
        from proxy.recording.errors import RecordingError  # noqa: PLC0415 - needs an extra
        from studies.bench.recorded import of_recording  # noqa: PLC0415
        from studies.replay.errors import ReplayError  # noqa: PLC0415
    except ImportError:
        raise RecordMissingError from None
    try:
        mission = of_recording(
            arguments.recording,
            arguments.specs,
            arguments.make.stem,
            about=arguments.about,
            latency=arguments.latency,
        )
    except (RecordingError, ReplayError) as error:
        raise BenchError(str(error)) from None
    arguments.make.write_text(text_of(mission), encoding="utf-8")
    _say(f"{arguments.make}: {len(mission.rows):,} samples of {len(mission.robots)} robots")


def _list() -> None:
    for path in find(None):
        print(f"{path.stem:<16} {load(path).head.about}")
    print()
    for name, policy in BUILT_IN.items():
        print(f"{name:<16} {policy.about}")


def _fly(arguments: argparse.Namespace) -> None:
    check_writable([arguments.json])
    check_writable([arguments.leaderboard], folders=True)
    missions = find(arguments.missions)
    ours = [] if arguments.only else list(BUILT_IN)
    policies = list(dict.fromkeys([*ours, *arguments.policy]))
    if not policies:
        raise BenchError("--only flies what --policy names: name one")
    scores = fly_all(missions, policies, arguments.jobs)
    to_output = arguments.json is not None and str(arguments.json) == "-"
    if arguments.json is not None:
        data = json.dumps(_data(scores), indent=2, allow_nan=False) + "\n"
        print(data, end="") if to_output else arguments.json.write_text(data, encoding="utf-8")
    if not to_output:
        print(text(scores))
    if arguments.leaderboard is not None:
        write_page(arguments.leaderboard, scores, missions, datetime.now(UTC))
        _say(f"{arguments.leaderboard}: written")


def _data(scores: Sequence[Score]) -> dict[str, object]:
    return {"version": VERSION, "scores": [asdict(score) | {"score": score.score} for score in scores]}


def _say(words: str) -> None:
    print(words, file=sys.stderr, flush=True)
