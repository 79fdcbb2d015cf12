"""`sendworthy check`: whether specs are fit to fly, and if not, why."""

from collections.abc import Sequence
from pathlib import Path
from typing import TextIO

from planner.utility import Custom, MessageUtility
from utility_specs.errors import SpecsError
from utility_specs.loader import LoadedFile, load_set
from utility_specs.specs import ConstraintSpec, InformationType


def check(paths: Sequence[Path], out: TextIO) -> int:
    """Check files and folders as one set; write summaries and return 0, or all problems and return 1."""
    try:
        files = load_set(paths).files
    except SpecsError as error:
        out.write(f"{error}\n")
        return 1
    for file in files:
        out.writelines(f"{line}\n" for line in _summary(file))
    return 0


def _summary(file: LoadedFile) -> list[str]:
    types = _counted(len(file.types), "information type")
    constraints = _counted(len(file.constraints), "constraint")
    return [
        f"{file.path}: {types}, {constraints}",
        *map(_type_line, file.types),
        *map(_constraint_line, file.constraints),
    ]


def _type_line(each: InformationType) -> str:
    worth = f"{_kind(each.utility)}, {each.aggregation}, scale {each.weight:g} × ({each.expression.text})"
    return f'  information_type "{each.name}": {", ".join(each.keys)} ({worth})'


def _kind(utility: MessageUtility) -> str:
    return f"python {utility.name}" if isinstance(utility, Custom) else type(utility).__name__.lower()


def _constraint_line(each: ConstraintSpec) -> str:
    rate = f"{each.rate * 8 / 1e6:g} Mbit/s"
    return f'  constraint "{each.name}": {each.limit:.0f} B in any {each.window:g} s ({rate})'


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"
