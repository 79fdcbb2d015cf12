"""`sendworthy check`: whether specs are fit to fly, and if not, why."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self, TextIO

from planner.airtime import Airtime
from planner.measures import Energy, Measure, Throughput
from utility_specs.errors import SpecProblem, SpecsError
from utility_specs.explaining import combined, kind_of
from utility_specs.findings import findings
from utility_specs.loader import LoadedFile, load_set
from utility_specs.specs import ConstraintSpec, InformationType


@dataclass(frozen=True, slots=True)
class Report:
    """What checking files as one set has found. With errors the specs are not fit to fly, with warnings they are."""

    files: tuple[LoadedFile, ...]
    errors: tuple[SpecProblem, ...]
    warnings: tuple[SpecProblem, ...] = ()

    @classmethod
    def on(cls, paths: Sequence[Path]) -> Self:
        """Check files and folders; where there are none, nothing is wrong."""
        try:
            files = load_set(paths).files if paths else ()
        except SpecsError as error:
            return cls((), error.problems)
        found = findings(files)
        errors = tuple(each.problem for each in found if each.unfit)
        return cls(files, errors, tuple(each.problem for each in found if not each.unfit))

    def lines(self) -> Iterator[str]:
        """Errors and warnings one by one, or without errors first of all what each file says."""
        if not self.errors:
            yield from (line for file in self.files for line in _summary(file))
        yield from map(str, self.errors)
        yield from (f"warning: {warning}" for warning in self.warnings)

    def data(self) -> dict[str, Any]:
        """The same as plain JSON data."""
        return {
            "fit": not self.errors,
            "errors": [_problem(each) for each in self.errors],
            "warnings": [_problem(each) for each in self.warnings],
            "files": [
                {
                    "file": str(file.path),
                    "information_types": {each.name: list(each.keys) for each in file.types},
                    "constraints": {each.name: _limit(each.measure) for each in file.constraints},
                }
                for file in self.files
            ],
        }


def check(paths: Sequence[Path], out: TextIO, *, as_json: bool = False) -> int:
    """Check files and folders as one set and write what was found; return 0, or 1 with any error."""
    return told(Report.on(paths), out, as_json=as_json)


def told(report: Report, out: TextIO, *, as_json: bool = False) -> int:
    """Write what was found; return 0, or 1 with any error."""
    if as_json:
        out.write(json.dumps(report.data(), indent=2) + "\n")
    else:
        out.writelines(f"{line}\n" for line in report.lines())
    return 1 if report.errors else 0


def _problem(each: SpecProblem) -> dict[str, Any]:
    return {"file": str(each.file), "line": each.line, "key": each.key, "message": each.message}


def _summary(file: LoadedFile) -> list[str]:
    types = _counted(len(file.types), "information type")
    constraints = _counted(len(file.constraints), "constraint")
    return [
        f"{file.path}: {types}, {constraints}",
        *map(_type_line, file.types),
        *map(_constraint_line, file.constraints),
    ]


def _type_line(each: InformationType) -> str:
    factors = {"weight": each.weighing.text.removesuffix(".0"), "scale": each.expression.text}
    said = [f"{name} {text}" for name, text in factors.items() if text != "1"]
    worth = ", ".join([kind_of(each.utility), combined(each.aggregation), *said])
    return f'  information_type "{each.name}": {", ".join(each.keys)} ({worth})'


def _constraint_line(each: ConstraintSpec) -> str:
    adaptive = f"; adaptive, down to {each.least * 100:.3g} % of it" if each.least < 1.0 else ""
    return f'  constraint "{each.name}": {_limit(each.measure)}{adaptive}'


def _limit(measure: Measure) -> str:
    """Say what a window may hold, and what that is in the terms of data sheets."""
    window = f"in any {measure.window:g} s"
    rate = measure.limit / measure.window
    match measure:
        case Throughput():
            return f"{measure.limit:.0f} B {window} ({_mbit(rate)})"
        case Airtime():
            air = f"{measure.wifi}, {measure.cast}, {_mbit(measure.phy_rate)}, {_counted(measure.hops, 'hop')}"
            kilobyte = f"1 kB takes {measure.use(1000, 1, own=True) * 1e3:.3g} ms"
            return f"{measure.limit * 1e3:g} ms on the air {window} ({rate * 100:g} %; {air}; {kilobyte})"
        case Energy():
            kilobyte = f"1 kB takes {measure.use(1000, 1, own=True) * 1e3:.3g} mJ"
            return f"{measure.limit:g} J of each robot {window} ({rate:g} W; {kilobyte})"
        case _:
            return f"{measure.limit:g} {measure.unit} {window} ({rate:g}/s)"


def _mbit(rate: float) -> str:
    return f"{rate * 8 / 1e6:g} Mbit/s"


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"
