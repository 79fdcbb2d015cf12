"""The characteristic (§4.1) of missions: recorded or imported ones, or of the benchmark; text, JSON and a picture."""

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from planner import Problem
from proxy.extras import needs, there
from proxy.output import check_writable
from proxy.printable import clean
from proxy.recording.reading import RecordingReader
from studies.bench.errors import BenchError
from studies.bench.folder import SUFFIX, load
from studies.given import once
from studies.replay.flight import TAIL
from studies.replay.mission import LATENCY, Mission
from studies.replay.policies import enter_all, problem_of
from studies.replay.recordings import Recordings, Survey
from studies.replay.specs import specs_of
from studies.study.characteristic import PROBABILITIES, Characteristic, at_random
from studies.study.errors import StudyError
from utility_specs import Specs
from utility_specs.loader import load_set

VERSION = 1
"""Of the JSON: what would be misread has a greater one."""
BAR = 40
"""Characters of the longest bar."""
ROWS = 10
"""Rows of the histogram in text."""
NAMED = 5
"""So many keys are named in an error."""
PICTURES = (".png", ".svg", ".pdf")

Report = dict[str, Any]


@dataclass(frozen=True, slots=True)
class _Mission:
    """What a report says of a mission."""

    robots: tuple[str, ...]
    samples: int
    seconds: float


def characteristic(arguments: argparse.Namespace) -> None:
    """Compute it, write what was asked for. Raises StudyError, ReplayError, RecordingError, SpecsError or OSError."""
    picture: Path | None = arguments.picture
    if picture is not None:
        if picture.suffix not in PICTURES:
            raise StudyError(f"{picture}: a picture is a file of {', '.join(PICTURES)}")
        if not there("matplotlib"):
            raise StudyError(f"--picture {needs('study')}")
    check_writable([arguments.json, picture])
    arguments.files = once(arguments.files)
    of_bench = [path for path in arguments.files if path.suffix == SUFFIX]
    mission, problem = _drawn(arguments) if of_bench else _recorded(arguments)
    found = Characteristic.of(at_random(problem, arguments.seed))
    report = _report(found, [path.name for path in arguments.files], mission)
    to_output = arguments.json is not None and str(arguments.json) == "-"
    if arguments.json is not None:
        text = json.dumps(report, indent=2, allow_nan=False) + "\n"
        print(text, end="") if to_output else arguments.json.write_text(text, encoding="utf-8")
    if not to_output:
        print(text_of(report))
    if picture is not None:
        _draw(found, report, picture)
        print(f"{picture}: written", file=sys.stderr)


def _recorded(arguments: argparse.Namespace) -> tuple[_Mission, Problem]:
    """Return what was recorded, and all samples that a spec covers as one problem. Raises StudyError for none."""
    recordings = Recordings(tuple(RecordingReader(path) for path in arguments.files))
    survey = recordings.survey()
    for problem in survey.problems:
        print(clean(f"sendworthy study: {problem}"), file=sys.stderr)
    latency = LATENCY if arguments.latency is None else arguments.latency
    mission = Mission(_specs(arguments, survey), tuple(sorted(survey.samples)), latency)
    found = _Mission(mission.robots, survey.samples.total(), survey.seconds)
    return found, _problem(recordings, survey, mission)


def _drawn(arguments: argparse.Namespace) -> tuple[_Mission, Problem]:
    """Return a mission of the benchmark. Raises StudyError where something else is named, too, or is wrong in it."""
    if len(arguments.files) > 1 or arguments.specs or arguments.latency is not None:
        raise StudyError("a mission of the benchmark is characterised alone, with its own specs and latency")
    try:
        mission = load(arguments.files[0])
    except BenchError as error:
        raise StudyError(str(error)) from None
    return _Mission(mission.robots, len(mission.rows), mission.head.seconds), mission.problem


def _specs(arguments: argparse.Namespace, survey: Survey) -> Specs:
    if arguments.specs is not None:
        return load_set(arguments.specs).specs
    if survey.specs is None:
        raise StudyError("what its samples are worth is not in the recording: name utility specs with --specs")
    return specs_of(survey.specs)


def _problem(recordings: Recordings, survey: Survey, mission: Mission) -> Problem:
    """Return all samples that a spec covers as one problem. Raises StudyError where there are none."""
    outcomes = enter_all(mission, recordings.told(frozenset(mission.robots)), survey.first)
    if all(stream.covering is None for stream in outcomes.streams):
        keys = ", ".join(sorted(stream.key for stream in outcomes.streams)[:NAMED])
        raise StudyError(f"the specs cover no key of this traffic; it has {keys}")
    return problem_of(outcomes, outcomes.columns(), survey.seconds + TAIL)


def _report(found: Characteristic, files: Sequence[str], mission: _Mission) -> Report:
    return {
        "version": VERSION,
        "files": list(files),
        "robots": list(mission.robots),
        "samples": mission.samples,
        "seconds": mission.seconds,
        "runs": len(PROBABILITIES),
        "received": len(found.utilities),
        "levels": found.levels,
        "best_half": found.best_half,
        "histogram": found.histogram().tolist(),
        "quantiles": {f"{q:g}": float(np.quantile(found.utilities, q)) for q in (0.05, 0.25, 0.5, 0.75, 0.95)},
    }


def text_of(report: Report) -> str:
    """Write the report for a terminal."""
    bars = np.array(report["histogram"]).reshape(ROWS, -1).sum(axis=1)
    robots = len(report["robots"])
    sent = f"{report['samples']:,} samples of {robots} robots in {report['seconds']:.0f} s, sent at random"
    lines = [
        f"{sent} {report['runs']} times with another probability each: {report['received']:,} were received.",
        "",
        "Expected utility [part of the greatest]   messages",
    ]
    for number, part in enumerate(bars.tolist()):
        bar = "█" * round(BAR * part / bars.max())
        lines.append(f"  {number / ROWS:.1f} to {(number + 1) / ROWS:.1f}  {100 * part:5.1f} %  {bar}".rstrip())
    levels = ", ".join(f"{100 * part:.0f} % {level}" for level, part in report["levels"].items())
    best = report["best_half"]
    lines += ["", f"Utility: {levels}. The better half of messages has {100 * best:.0f} % of all that is gained."]
    lines.append(f"So {_advice(best)}.")
    return "\n".join(lines)


def _advice(best_half: float) -> str:
    """Say what that means for whoever has a limit."""
    if best_half < 0.6:
        return "messages are nearly alike: it matters little which are sent, and a planner gains little by choosing"
    if best_half < 0.8:
        return "messages differ: where half of them must be dropped, choosing well gains a good part"
    return "a few messages have nearly all of the utility: who drops at random loses most of it, and a planner does not"


def _draw(found: Characteristic, report: Report, path: Path) -> None:
    from studies.study.drawing import one_axes  # noqa: PLC0415 - matplotlib takes a second
    from studies.study.figures import draw_characteristic  # noqa: PLC0415

    with one_axes(path) as axes:
        draw_characteristic(axes, found)
        axes.set_ylabel("messages [%]")
        axes.set_title(f"Characteristic of {', '.join(report['files'][:2])}", fontsize=10, pad=22)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2, frameon=False)
