"""What is wrong or odd with specs that can be loaded: guarantees nobody can keep, what is never used, never binds."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import zenoh

from planner.problem import Aggregation
from planner.utility import Custom
from utility_specs import digests
from utility_specs.constraint_tables import AnyConstraintTable
from utility_specs.errors import SpecProblem
from utility_specs.loader import LoadedFile
from utility_specs.schedules import PeriodicRule, PoissonRule, TimesRule
from utility_specs.schema import InformationTypeTable
from utility_specs.specs import ConstraintSpec, InformationType
from utility_specs.suggestions import listed, quoted
from utility_specs.toml_lines import KeyPath

TOO_MUCH = 1.0 + 1e-9
"""Sums of what is guaranteed may be off by rounding."""
MOST_TOLD = 8
"""Guarantees that are named where all together are too many."""


@dataclass(frozen=True, slots=True)
class Finding:
    """A problem, and whether it makes specs unfit: else it is a warning."""

    problem: SpecProblem
    unfit: bool = False


@dataclass(frozen=True, slots=True)
class _Type:
    file: LoadedFile
    index: int
    table: InformationTypeTable
    type: InformationType

    def finding(self, key: str, message: str, *, unfit: bool = False) -> Finding:
        path: KeyPath = ("information_type", self.index, *key.split("."))
        return Finding(self.file.source.problem(path, message), unfit)

    @property
    def generates(self) -> float | None:
        """Samples of each stream [1/s]; None where it has to be found out."""
        match self.type.schedule:
            case PeriodicRule(period):
                return 1.0 / period
            case PoissonRule(interval):
                return 1.0 / interval
            case TimesRule(times, every) if every is not None:
                return len(times) / every
            case _:
                return None

    @property
    def guaranteed(self) -> float:
        """Samples of each stream that have to be sent, as far as there are so many [1/s]."""
        return min(self.type.guarantee.rate, self.generates or self.type.guarantee.rate)

    @property
    def size(self) -> int:
        """Bytes of a sample, at least."""
        return max(1, round(self.table.forecast.size or 1.0))


@dataclass(frozen=True, slots=True)
class _Constraint:
    file: LoadedFile
    index: int
    table: AnyConstraintTable
    spec: ConstraintSpec

    def finding(self, key: str, message: str, *, unfit: bool = False) -> Finding:
        return Finding(self.file.source.problem(("constraint", self.index, key), message), unfit)

    @property
    def measured(self) -> dict[str, object]:
        """What it measures, whatever the limit."""
        return self.table.model_dump(exclude={"name", "limit", "floor", "ceiling", "window"})


def findings(files: Sequence[LoadedFile]) -> list[Finding]:
    """Return all that is found, file by file in the order of the lines."""
    types = [
        _Type(file, index, table, of)
        for file in files
        for index, (table, of) in enumerate(zip(file.tables.information_type, file.types, strict=True))
    ]
    constraints = [
        _Constraint(file, index, table, spec)
        for file in files
        for index, (table, spec) in enumerate(zip(file.tables.constraint, file.constraints, strict=True))
    ]
    found = [
        *_shadowed(types),
        *(finding for each in types for finding in (*_unused(each), *_idle(each))),
        *(finding for file in files for finding in _unused_constants(file)),
        *(finding for each in constraints for finding in (*_large(each, types), *_overcommitted(each, types))),
        *_never_binding(constraints),
    ]
    order = {file.path: number for number, file in enumerate(files)}
    return sorted(found, key=lambda each: (order[each.problem.file], each.problem.line or 0))


def _shadowed(types: Sequence[_Type]) -> Iterator[Finding]:
    """Keys of which an earlier type takes every one."""
    earlier: list[tuple[zenoh.KeyExpr, str]] = []
    for each in types:
        own = [zenoh.KeyExpr(key) for key in each.type.keys]
        takers = [next((name for taken, name in earlier if taken.includes(key)), None) for key in own]
        names = [name for name in dict.fromkeys(takers) if name is not None]
        if None not in takers:
            yield each.finding("keys", f"all belong to {listed(names)} before it, so this type covers nothing")
        else:
            for key, taker in zip(each.type.keys, takers, strict=True):
                if taker is not None:
                    yield each.finding("keys", f"{quoted(key)} belongs to {quoted(taker)} before it")
        earlier += [(key, each.type.name) for key in own]


def _unused(each: _Type) -> Iterator[Finding]:
    """Features that cost time for nothing: a Python utility gets all of them."""
    if isinstance(each.type.utility, Custom):
        return
    for name, _ in each.type.features:
        if name not in each.type.expression.names | each.type.weighing.names:
            yield each.finding(f"features.{name}", "nothing uses this feature; it is computed all the same")


def _unused_constants(file: LoadedFile) -> Iterator[Finding]:
    used = {name for each in file.types for name in each.expression.names | each.weighing.names}
    for name in [name for name in file.tables.constants if name not in used]:
        yield Finding(file.source.problem(("constants", name), "nothing in this file uses this constant"))


def _idle(each: _Type) -> Iterator[Finding]:
    """What has no effect, or none that can be had."""
    said, generates = each.type.guarantee, each.generates
    needed = {"min_rate": said.min_rate, "max_age": 1.0 / said.max_age if said.max_age else None}
    for key, rate in needed.items():
        if rate is None:
            continue
        if not each.type.planned:
            yield each.finding(key, "has no effect: nothing decides on this type")
        elif generates is not None and rate > generates * TOO_MUCH:
            message = f"takes {rate:g} samples per second, and forecast.schedule says that there are {generates:g}"
            yield each.finding(key, message, unfit=True)
        elif each.type.aggregation is Aggregation.ONCE:
            yield each.finding(key, 'ends with the first sample: with aggregation = "once" each robot is sent no other')
    if each.type.bypass and each.type.mode is not None:
        yield each.finding("mode", "has no effect: with bypass everything goes")


def _large(each: _Constraint, types: Sequence[_Type]) -> Iterator[Finding]:
    """Limits that hold little beside digests, and samples that fill more than a window: they can be sent, rarely."""
    measure = each.spec.measure
    if measure.use(1, 1, own=True) > measure.limit:
        window = f"in any {measure.window:g} s"
        yield each.finding("limit", f"is too low for a single sample of one byte {window}: almost nothing can be sent")
        return
    if warning := digests.warning(measure, digests.TEAM):
        yield each.finding("limit", warning)
    for one in types:
        part = measure.use(one.size, 1, own=True) / measure.limit
        if one.type.planned and part > TOO_MUCH:
            what = f"is {part:.3g} times what {quoted(each.spec.name)} lets pass in {measure.window:g} s"
            often = f"one can be sent every {part * measure.window:.3g} s, and little beside it"
            yield one.finding("forecast.size", f"{what}: {often}")


def _overcommitted(each: _Constraint, types: Sequence[_Type]) -> Iterator[Finding]:
    """Guarantees that take more than there is, even with one copy of each sample."""
    measure = each.spec.measure
    parts = {}
    for one in types:
        if one.type.planned and one.guaranteed > 0.0:
            streams = 1 if measure.private else one.table.forecast.streams
            use = measure.use(one.size, 1, own=True) * one.guaranteed * streams
            parts[one.type.name] = use * measure.window / measure.limit
    part = sum(parts.values())
    if part <= each.spec.least * TOO_MUCH:
        return
    most = sorted(parts, key=lambda name: -parts[name])[:MOST_TOLD]
    told = [f"{quoted(name)} ({parts[name] * 100:.3g} %)" for name in most]
    what = f"is less than what is guaranteed: {', '.join(told)}" + (" and more" if len(parts) > len(told) else "")
    if part > TOO_MUCH:
        yield each.finding("limit", what, unfit=True)
    else:
        yield each.finding("limit", f"at its floor, {each.spec.least * 100:.3g} % of the ceiling, {what}")


def _never_binding(constraints: Sequence[_Constraint]) -> Iterator[Finding]:
    """Limits that another one of the same kind never lets anybody reach."""
    useless: set[int] = set()
    for (i, one), (j, other) in combinations(enumerate(constraints), 2):
        if one.measured != other.measured:
            continue
        for (k, tight), (n, loose) in (((i, one), (j, other)), ((j, other), (i, one))):
            if k not in useless and n not in useless and _implies(tight.spec, loose.spec):
                useless.add(n)
                least = "even at its floor it never binds" if loose.spec.least < 1.0 else "never binds"
                yield loose.finding("limit", f"{least}: {quoted(tight.spec.name)} lets no more pass")


def _implies(tight: ConstraintSpec, loose: ConstraintSpec) -> bool:
    """Whether what satisfies one constraint always satisfies the other: a window lies within a longer one."""
    less = tight.measure.limit <= loose.measure.limit * loose.least * TOO_MUCH
    return less and tight.measure.window >= loose.measure.window
