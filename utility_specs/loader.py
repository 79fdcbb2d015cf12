"""From files to specs: all files are read as one set, and all their problems are reported at once."""

import hashlib
import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from pydantic import ValidationError

from planner.errors import ProblemError
from utility_specs.errors import SpecProblem, SpecsError, TomlError
from utility_specs.forecast import forecast_of
from utility_specs.rules import FLOOR, Guarantee
from utility_specs.schedules import rule_of
from utility_specs.schema import FallbackTable, InformationTypeTable, SpecFile
from utility_specs.specs import ConstraintSpec, InformationType, Specs
from utility_specs.suggestions import hint, quoted
from utility_specs.toml_source import MOST_PROBLEMS, TomlSource, problems_of


@dataclass(frozen=True, slots=True)
class LoadedFile:
    """What one file of a set contributes, and where it is written."""

    path: Path
    source: TomlSource
    tables: SpecFile
    types: tuple[InformationType, ...]
    constraints: tuple[ConstraintSpec, ...]


@dataclass(frozen=True, slots=True)
class SpecSet:
    """Specs and the files that they come from."""

    files: tuple[LoadedFile, ...]
    specs: Specs


def load_specs(path: Path) -> Specs:
    """Load a file, or all `*.toml` of a folder sorted by name; raises SpecsError with every problem."""
    return load_set([path]).specs


def load_set(paths: Sequence[Path]) -> SpecSet:
    """Load files and folders as one set of specs; raises SpecsError with every problem of all of them."""
    problems: list[SpecProblem] = []
    sources: list[TomlSource] = []
    tables: list[SpecFile] = []
    for path in _files_of(paths, problems):
        try:
            sources.append(TomlSource.read(path))
            tables.append(SpecFile.of(sources[-1].data, folder=path.parent))
            problems += _failing(sources[-1], tables[-1])
        except TomlError as error:
            problems += error.problems
        except ValidationError as error:
            problems += problems_of(error, sources[-1], SpecFile)
    problems += _repeated(sources, "information_type") + _repeated(sources, "constraint") + _set_again(sources)
    if not problems and not any(table.information_type for table in tables):
        where = sources[0].path if len(sources) == 1 else paths[0]
        problems.append(SpecProblem(where, None, "information_type", "is missing; a spec needs at least one"))
    if problems:
        order = {source.path: number for number, source in enumerate(sources)}
        raise SpecsError(sorted(problems, key=lambda problem: (order.get(problem.file, -1), problem.line or math.inf)))
    return _assembled(sources, tables)


def spec_files(path: Path) -> list[Path]:
    """Return the files that a path stands for: of a folder its `*.toml`, sorted by name; raises OSError.

    Hidden ones are not meant: editors put locks there, such as `.#camera.toml`, which lead nowhere.
    """
    if not path.is_dir():
        return [path]
    # `glob` hides that it may not look
    return sorted(file for file in path.iterdir() if file.suffix == ".toml" and not file.name.startswith("."))


def holds_specs(path: Path) -> bool:
    """Whether there is anything to load; also where that cannot be told, so that loading it says why."""
    try:
        return path.exists() and bool(spec_files(path))
    except OSError:
        return True


def _files_of(paths: Iterable[Path], problems: list[SpecProblem]) -> list[Path]:
    """Return the files that the paths name, each once; folders stand for their `*.toml`, sorted by name."""
    files: dict[Path, Path] = {}
    for path in paths:
        try:
            found = spec_files(path)
            files |= {file.resolve(): file for file in found if file.resolve() not in files}
        except (
            OSError,
            RuntimeError,
            ValueError,
        ) as error:  # RuntimeError: links in a circle; ValueError: a NUL
            problems.append(SpecProblem(path, None, "", f"cannot be read: {getattr(error, 'strerror', error)}"))
        else:
            if not found:
                problems.append(SpecProblem(path, None, "", "has no *.toml file in it"))
    return list(files.values())


def _failing(source: TomlSource, file: SpecFile) -> list[SpecProblem]:
    """Return a problem for each utility or aggregation that cannot be made, such as a Python function that raises."""
    problems = []
    for index, table in enumerate(file.information_type):
        forecast = table.forecast
        for key, make in (
            (("utility",), table.message_utility),
            (("aggregation",), table.aggregated),
            (("forecast", "features"), partial(forecast_of, forecast.features)),
            (("forecast", "schedule"), partial(rule_of, forecast.schedule)),
        ):
            try:
                make()
            except ProblemError as error:
                message = " ".join(str(error).removeprefix(f"{table.utility.kind} utility: ").split())
                problems.append(source.problem(("information_type", index, *key), message))
                break
        problems += [
            source.problem(
                ("information_type", index, "forecast", "features", name),
                f"unknown feature {quoted(name)}" + (hint(name, table.features) or " (this type has no features)"),
            )
            for name in (forecast.features if isinstance(forecast.features, dict) else ())
            if name not in table.features
        ]
    return problems[:MOST_PROBLEMS]


def _repeated(sources: Iterable[TomlSource], key: str) -> list[SpecProblem]:
    """Return a problem for each name that an earlier table has too; files with other problems count."""
    seen: dict[str, str] = {}
    problems = []
    for source in sources:
        for path, name in _names(source, key):
            if name in seen:
                problems.append(source.problem(path, f"{quoted(name)} is already the name of the one at {seen[name]}"))
            else:
                seen[name] = f"{source.path}:{source.line_of(path)}"
    return problems[:MOST_PROBLEMS]


def _set_again(sources: Sequence[TomlSource]) -> list[SpecProblem]:
    """Return a problem for each setting of the whole set that an earlier file has too."""
    problems = []
    for key in ("floor", "fallback"):
        setting = [source for source in sources if key in source.data]
        for source in setting[1:]:
            where = f"{setting[0].path}:{setting[0].line_of((key,))}"
            problems.append(source.problem((key,), f"is already set at {where}, for all files"))
    return problems[:MOST_PROBLEMS]


def _names(source: TomlSource, key: str) -> Iterator[tuple[tuple[str | int, ...], str]]:
    tables = source.data.get(key)
    for index, table in enumerate(tables if isinstance(tables, list) else ()):
        if isinstance(table, dict) and isinstance(table.get("name"), str):
            yield (key, index, "name"), table["name"]


def _assembled(sources: Iterable[TomlSource], tables: Sequence[SpecFile]) -> SpecSet:
    names = _constraint_names(tables)
    files = tuple(
        LoadedFile(
            source.path,
            source,
            table,
            tuple(_information_type(each, table.constants) for each in table.information_type),
            tuple(ConstraintSpec(next(names), c.measure(), c.least) for c in table.constraint),
        )
        for source, table in zip(sources, tables, strict=True)
    )
    types = tuple(each for file in files for each in file.types)
    constraints = tuple(each for file in files for each in file.constraints)
    floor = next((table.floor for table in tables if table.floor is not None), FLOOR)
    fallback = next((table.fallback for table in tables if table.fallback is not None), FallbackTable()).fallback()
    texts = tuple((file.path.name, file.source.text) for file in files)
    return SpecSet(files, Specs(types, constraints, _generation(tables), fallback, floor, texts))


def _information_type(table: InformationTypeTable, constants: Mapping[str, float]) -> InformationType:
    weight, scale = table.expressions(constants)
    return InformationType(
        name=table.name,
        formats=table.formats,
        aggregation=table.aggregated(),
        weighing=weight,
        utility=table.message_utility(),
        expression=scale,
        features=tuple((name, feature.feature()) for name, feature in table.features.items()),
        forecast=forecast_of(table.forecast.features),
        schedule=rule_of(table.forecast.schedule),
        mode=table.mode,
        bypass=table.bypass,
        guarantee=Guarantee(table.min_rate, table.max_age),
        deletes=table.deletes,
        queries=table.queries,
    )


def _constraint_names(tables: Iterable[SpecFile]) -> Iterator[str]:
    """Yield a name for every constraint in turn: its own, or its kind, numbered from the second on."""
    constraints = [each for table in tables for each in table.constraint]
    taken = {each.name for each in constraints}
    nameless: Counter[str] = Counter()
    for each in constraints:
        name = each.name
        while name is None:
            nameless[each.kind] += 1
            count = nameless[each.kind]
            proposal = each.kind if count == 1 else f"{each.kind} {count}"
            name = None if proposal in taken else proposal
        yield name


def _generation(tables: Iterable[SpecFile]) -> str:
    """Return a hash of what the specs say, whatever files they stand in and whatever their comments."""
    types = [[each.model_dump(), table.constants] for table in tables for each in table.information_type]
    constraints = [each.model_dump() for table in tables for each in table.constraint]
    rules = [[table.floor, table.fallback and table.fallback.model_dump()] for table in tables]
    rules = [each for each in rules if any(rule is not None for rule in each)]
    said = json.dumps([types, constraints, rules], sort_keys=True, allow_nan=False)
    return hashlib.sha256(said.encode()).hexdigest()[:12]
