"""Runs a replay that was asked for on the command line, and writes its report."""

import argparse
import json
import sys
from collections.abc import Iterator, Sequence

import numpy as np

from proxy import exit_codes
from proxy.extras import needs, there
from proxy.output import check_writable
from proxy.printable import clean
from proxy.recording.entries import SpecsText
from proxy.recording.errors import RecordingError
from proxy.recording.reading import RecordingReader
from studies.given import once
from studies.oracle import OracleError
from studies.replay import policies
from studies.replay.adaptive import as_borne
from studies.replay.bound import Bound, bound
from studies.replay.errors import ReplayError
from studies.replay.exact import all_equal
from studies.replay.flight import TAIL, Flight
from studies.replay.mission import LATENCY, Mission, with_limit
from studies.replay.outcomes import Outcomes
from studies.replay.pieces import borders_of
from studies.replay.progress import Progress
from studies.replay.recordings import Recordings, Survey, opened
from studies.replay.report import Flown, Report, report
from studies.replay.samples import SENT, Fate, Sample, Told
from studies.replay.specs import specs_of
from studies.replay.table import table
from utility_specs import Specs
from utility_specs.loader import load_set

ITERATIONS = 300
"""Of a search, unless somebody says otherwise."""
NAMED = 5
"""So many keys are named in an error."""


WHAT_IF = ("specs", "limit", "robots", "policy", "iterations", "latency", "loss", "seed")
"""Arguments with which traffic is flown anew."""


def replay(arguments: argparse.Namespace) -> int:
    """Replay, print and write what was asked for; return the exit code. Raises ReplayError, SpecsError or OSError."""
    _check_extras(arguments)
    check_writable([arguments.json, arguments.html])
    asked = any(getattr(arguments, name) is not None for name in WHAT_IF)
    arguments.files = once(arguments.files)
    files, problems = opened(arguments.files)
    if asked or any(file.start.kind == "traffic" for file in files):
        if problems:
            raise ReplayError("; ".join(problems))
        _report(arguments, *_prepared(arguments, files, exact=False), exact=False)
        return exit_codes.OK
    for problem in problems:
        _say(f"sendworthy replay: {problem}")
    output = sys.stderr if str(arguments.json) == "-" else sys.stdout
    alike = all_equal(files, output, python=arguments.python)
    if not problems and (arguments.json is not None or arguments.html is not None):
        _report(arguments, *_prepared(arguments, files, exact=True), exact=True)
    return exit_codes.OK if alike and not problems else exit_codes.FAILED


def _check_extras(arguments: argparse.Namespace) -> None:
    """Raise ReplayError where a package is not there that will be needed."""
    if arguments.html is not None and not there("matplotlib"):
        raise ReplayError(f"--html {needs('study')}")
    flown = arguments.json is not None or arguments.html is not None or any(vars(arguments)[n] for n in WHAT_IF)
    if flown and not arguments.no_bound and not there("scipy"):
        raise ReplayError(f"the bound {needs('study')}; --no-bound does without")


def _prepared(
    arguments: argparse.Namespace, files: Sequence[RecordingReader], *, exact: bool
) -> tuple[Recordings, Survey, Mission]:
    """Look at the recordings, and return what is to be flown. Raises ReplayError or SpecsError."""
    recordings = Recordings(files)
    survey = recordings.survey()
    for problem in survey.problems:
        _say(f"sendworthy replay: {problem}")
    robots = _robots(arguments.robots, survey)
    latency = LATENCY if arguments.latency is None else arguments.latency
    specs = _specs(arguments, survey)
    if not exact:
        specs, notes = as_borne(specs, survey.borne, _compared(arguments, survey, specs))
        survey.problems += notes
    return recordings, survey, Mission(specs, robots, latency, arguments.loss or 0.0)


def _robots(wanted: Sequence[str] | None, survey: Survey) -> tuple[str, ...]:
    """Return the robots asked for, or all. Raises ReplayError for one that published nothing."""
    known = sorted(survey.samples)
    chosen = [name for each in wanted or () for name in each.split(",") if name]
    for name in chosen:
        if name not in survey.samples:
            raise ReplayError(f'no robot "{name}" published anything; there are {", ".join(known[:20])}')
    return tuple(dict.fromkeys(chosen)) or tuple(known)


def _specs(arguments: argparse.Namespace, survey: Survey) -> Specs:
    """Return the specs to fly by. Raises ReplayError or SpecsError."""
    if arguments.specs is not None:
        specs = load_set(arguments.specs).specs
    elif survey.specs is not None:
        specs = _recorded(arguments, survey.specs)
    else:
        raise ReplayError("what its samples are worth is not in the recording: name utility specs with --specs")
    return specs if arguments.limit is None else with_limit(specs, arguments.limit)


def _recorded(arguments: argparse.Namespace, text: SpecsText) -> Specs:
    """Return the specs that were recorded. Raises ReplayError where they cannot be read."""
    try:
        return specs_of(text, python=arguments.python)
    except RecordingError as error:
        raise ReplayError(f"{error}; --specs names others") from None


def _compared(arguments: argparse.Namespace, survey: Survey, specs: Specs) -> Specs | None:
    """Return the specs that were recorded, where others are flown whose limits follow the channel.

    Raises ReplayError where they cannot be read.
    """
    adaptive = any(limit.least < 1.0 for limit in specs.constraints)
    if arguments.specs is None or survey.specs is None or not (adaptive and survey.borne.parts):
        return None
    try:
        return specs_of(survey.specs, python=arguments.python)
    except RecordingError as error:
        told = "what the channel bore is recorded as parts of limits that are not known"
        raise ReplayError(f"{told}: {error}; --limit names a throughput instead") from None


def _fly(
    arguments: argparse.Namespace, mission: Mission, told: Iterator[Told], survey: Survey
) -> tuple[Outcomes, float]:
    """Fly the traffic anew; return what became of it, and the bytes that robots told each other."""
    progress = Progress(lambda done: f"replayed {done:,.0f} s of {survey.seconds:,.0f} s")
    if arguments.policy in (None, policies.PLANNER):
        iterations = ITERATIONS if arguments.iterations is None else arguments.iterations
        flight = Flight(mission, told, iterations=iterations, seed=arguments.seed or 0, origin=survey.first)
        outcomes = flight.fly(progress)
        on_air = float(flight.told_on_air()[1].sum())
    else:
        outcomes = policies.enter_all(mission, told, survey.first)
        policies.fly(outcomes, arguments.policy, survey.seconds + TAIL, progress, arguments.seed or 0)
        on_air = 0.0
    progress.end()
    return outcomes, on_air


def _as_it_was(mission: Mission, told: Iterator[Told], survey: Survey) -> Outcomes:
    """Return what became of the samples when they were recorded."""
    outcomes = Outcomes(mission)
    for each in told:
        t = each.t - survey.first
        if isinstance(each, Sample):
            outcomes.enter(each, t)
        elif isinstance(each, Fate):
            number = outcomes.note(each)
            if number is None:
                continue
            if each.seconds is not None:
                outcomes.searched(number, each.seconds)
            if each.reason == SENT:
                outcomes.send(number, t, t + mission.latency, each.reason)
            else:
                outcomes.settle(number, each.reason)
    return outcomes


def _report(
    arguments: argparse.Namespace, recordings: Recordings, survey: Survey, mission: Mission, *, exact: bool
) -> None:
    """Fly the traffic, or take it as it was; score that and write it where it was asked for."""
    told, on_air = recordings.told(frozenset(mission.robots)), 0.0
    if exact:
        outcomes = _as_it_was(mission, told, survey)
    else:
        outcomes, on_air = _fly(arguments, mission, told, survey)
    if not any(stream.covering is not None for stream in outcomes.streams):
        keys = ", ".join(sorted(stream.key for stream in outcomes.streams)[:NAMED])
        raise ReplayError(f"the specs cover no key of this traffic; it has {keys}")
    columns = outcomes.columns()
    borders = borders_of(columns.t, float(columns.t[-1]) + TAIL)
    flown, notes = Flown(outcomes, columns, borders), _notes(arguments, outcomes, survey)
    bounded = None if arguments.no_bound else _bounded(flown, notes)
    _write(arguments, _headed(arguments, mission, exact=exact) | report(flown, bounded, on_air) | {"notes": notes})


def _write(arguments: argparse.Namespace, found: Report) -> None:
    """Print the table, or JSON in its place, and write the files asked for."""
    to_output = arguments.json is not None and str(arguments.json) == "-"
    if arguments.json is not None:
        text = json.dumps(found, indent=2, allow_nan=False) + "\n"
        print(text, end="") if to_output else arguments.json.write_text(text, encoding="utf-8")
    if not to_output:
        notes = (clean(f"note: {note}") for note in found["notes"])
        print("\n".join([clean(found["about"]), "", table(found), *notes]))
    if arguments.html is not None:
        from studies.replay.page import page  # noqa: PLC0415 - matplotlib takes a second

        arguments.html.write_text(page(found), encoding="utf-8")
        _say(f"{arguments.html}: written")


def _bounded(flown: Flown, notes: list[str]) -> Bound | None:
    """Return the bound; where there is none a note says why."""
    count = len(flown.borders) - 1
    progress = Progress(lambda done: f"pieces bounded: {done:.0f} of {count}")
    try:
        return bound(flown.outcomes, flown.columns, flown.borders, lambda done, _: progress(done))
    except (ReplayError, OracleError) as error:
        notes.append(str(error))
        return None
    finally:
        progress.end()


def _headed(arguments: argparse.Namespace, mission: Mission, *, exact: bool) -> Report:
    """Return what was replayed, and how."""
    names = ", ".join(mission.robots[:NAMED]) + (", …" if len(mission.robots) > NAMED else "")
    policy = arguments.policy or policies.PLANNER
    how = f"flown anew by the policy {policy}" if not exact else "as it was recorded"
    return {
        "files": [file.name for file in arguments.files],
        "robots": list(mission.robots),
        "exact": exact,
        "policy": policy,
        "iterations": arguments.iterations or ITERATIONS,
        "seed": arguments.seed or 0,
        "latency": mission.latency,
        "loss": mission.loss,
        "about": f"Traffic of {names}, {how}, to one operator {1000 * mission.latency:g} ms away"
        + (f", {mission.loss:.3g} of it lost." if mission.loss else "."),
    }


def _notes(arguments: argparse.Namespace, outcomes: Outcomes, survey: Survey) -> list[str]:
    notes = list(survey.problems)
    for feature, count in outcomes.lacking.most_common():
        notes.append(f"the feature {feature} of {count:,} samples was not recorded, and has its default")
    if survey.superseded:
        notes.append(
            f"{survey.superseded:,} samples gave way to newer ones before anybody looked at them, and are left out"
        )
    if arguments.policy == "rank":
        notes.append(f"the policy rank knows the next {policies.AHEAD} samples beforehand, as no robot does")
    undecided = int(np.sum(outcomes.columns().fate == 0))
    if undecided:
        notes.append(f"{undecided:,} samples still waited at the end")
    return notes


def _say(text: str) -> None:
    print(clean(text), file=sys.stderr, flush=True)
