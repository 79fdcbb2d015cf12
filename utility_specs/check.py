"""`sendworthy check`: whether specs are fit to fly, and if not, why."""

from collections.abc import Sequence
from pathlib import Path
from typing import TextIO

from planner.airtime import Airtime
from planner.measures import Energy, Measure, Throughput
from planner.problem import Aggregation, AggregationModel
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
    scale = f"scale {each.weight.text.removesuffix('.0')} × ({each.expression.text})"
    worth = f"{_kind(each.utility)}, {_combined(each.aggregation)}, {scale}"
    return f'  information_type "{each.name}": {", ".join(each.keys)} ({worth})'


def _kind(utility: MessageUtility) -> str:
    return f"python {utility.name}" if isinstance(utility, Custom) else type(utility).__name__.lower()


def _combined(aggregation: Aggregation | AggregationModel) -> str:
    if isinstance(aggregation, Aggregation):
        return str(aggregation)
    return f"python {type(aggregation).__module__}:{type(aggregation).__qualname__}"


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
