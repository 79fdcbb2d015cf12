"""Writes a recording of what files of others hold, sample by sample."""

import argparse
import os
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from heapq import merge
from operator import attrgetter
from pathlib import Path
from typing import Protocol

from proxy.config_values import robot_name
from proxy.printable import clean
from proxy.recording.entries import Payload, Start, Traffic
from proxy.recording.writing import RecordingWriter
from studies.foreign.arrived import Arrived
from studies.foreign.csv_files import Table
from studies.foreign.errors import ImportFailedError
from utility_specs import Specs
from utility_specs.loader import load_set

ENCODING = "application/cdr"
"""Of the payloads of ROS 2."""


class Source(Protocol):
    """A file of others."""

    def samples(self) -> Iterator[Arrived]:
        """Yield its samples in the order of time."""


@dataclass(slots=True)
class Imported:
    """What was written: samples by robot, and keys."""

    samples: Counter[str] = field(default_factory=Counter)
    keys: set[str] = field(default_factory=set)
    first: float = 0.0
    last: float = 0.0
    count: int = 0

    def note(self, sample: Arrived) -> None:
        """Count a sample."""
        if not self.count:
            self.first = sample.t_gen
        self.samples[sample.robot] += 1
        self.keys.add(sample.key)
        self.last = sample.t_gen
        self.count += 1


def make(arguments: argparse.Namespace, bags: Sequence[Path]) -> None:
    """Make the recording, and say what is in it. Raises ImportFailedError, SpecsError or OSError."""
    specs = None if arguments.specs is None else load_set(arguments.specs).specs
    output: Path = arguments.output
    if not output.parent.is_dir():
        raise ImportFailedError(f"-o {output}: there is no folder {output.parent}")
    if output.exists() and not arguments.force:
        raise ImportFailedError(f"{output} exists; --force replaces it")
    if output.exists() and not output.is_file():
        raise ImportFailedError(f"{output} is no file that could be replaced")
    if any(output.exists() and path.exists() and path.samefile(output) for path in arguments.files):
        raise ImportFailedError(f"{output} is what is to be imported; name another file with -o")
    _check_robots(arguments, bags)
    sources = [_source(path, arguments, bag=path in bags) for path in arguments.files]
    target = Path(os.path.realpath(output))
    beside = target.with_name(f".{target.name}.new")
    beside.unlink(missing_ok=True)
    try:
        written = _written(sources, beside, specs, ", ".join(map(str, arguments.files)))
        beside.replace(target)
    except BaseException:
        with suppress(OSError):
            beside.unlink(missing_ok=True)
        raise
    for source in sources:
        for problem in getattr(source, "problems", []):
            print(clean(f"sendworthy import: {problem}"), file=sys.stderr)
        for column in getattr(source, "ignored", []):
            print(clean(f'sendworthy import: the column "{column}" is text, and ignored'), file=sys.stderr)
    print(clean(_said(output, written)))


def _check_robots(arguments: argparse.Namespace, bags: Sequence[Path]) -> None:
    """Say so where bags are taken for one robot's. Raises ImportFailedError where --robot makes no sense."""
    if arguments.robot is not None:
        if len(bags) > 1:
            raise ImportFailedError("--robot names the robot of one bag; several are named after their files")
        try:
            robot_name(arguments.robot)
        except ValueError as error:
            raise ImportFailedError(f"--robot {error}") from None
    names = Counter(path.resolve().stem for path in bags)
    for name in [name for name, count in names.items() if count > 1 and not arguments.by_namespace]:
        told = f"{names[name]} bags are taken for those of one robot, as they are named {name}"
        print(clean(f"sendworthy import: {told}; robots are named after files"), file=sys.stderr)


def _source(path: Path, arguments: argparse.Namespace, *, bag: bool) -> Source:
    if not bag:
        return Table(path)
    from studies.foreign.bags import Bag  # noqa: PLC0415 - needs the extra "ros2"

    robot = arguments.robot or path.resolve().stem
    return Bag(path, robot, arguments.by_namespace, arguments.topics_as_keys, arguments.domain)


def _written(sources: Sequence[Source], path: Path, specs: Specs | None, source: str) -> Imported:
    """Write everything; return what it was."""
    imported = Imported()
    with RecordingWriter(path, Start("traffic", source=source, payloads=specs is None)) as writer:
        for sample in merge(*(each.samples() for each in sources), key=attrgetter("t_gen")):
            imported.note(sample)
            features = dict(sample.features)
            covering = None if specs is None else specs.match(sample.key)
            if covering is not None and sample.payload is not None:
                features |= covering.extract(sample.key, sample.payload)
            if specs is None and sample.payload is not None:
                writer.payload(Payload(imported.count, sample.key, sample.payload), ENCODING, sample.t_gen)
            writer.traffic(Traffic(sample.robot, sample.key, sample.t_gen, sample.size, features))
    return imported


def _said(output: Path, imported: Imported) -> str:
    robots = ", ".join(f"{robot} ({n:,})" for robot, n in imported.samples.most_common(8))
    more = len(imported.samples) - 8
    others = f" and {more} more" if more > 0 else ""
    span = f"{imported.last - imported.first:,.1f} s"
    return f"{output}: {imported.count:,} samples of {robots}{others} on {len(imported.keys):,} keys, {span}"
