"""Reads the configuration: defaults, under the file, under the environment, under the flags.

All mistakes are reported at once, each with its file, line and key, its variable or its flag.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from proxy.config import Config, SpecsConfig, settings
from proxy.config_layers import Layers, Override, flags, variables
from proxy.errors import ConfigError
from utility_specs.errors import TomlError
from utility_specs.loader import holds_specs
from utility_specs.suggestions import hint
from utility_specs.toml_lines import KeyPath
from utility_specs.toml_source import TomlSource
from utility_specs.wording import Place, message_of

SETTINGS = {setting.path: setting for setting in settings()}
SPECS = ("specs", "path")
RECORDINGS = ("record", "folder")
COORDINATION = ("planner", "coordination")
RENAMED = {"auto": "announce", "overhear": "announce", "shares": "split"}
"""What older versions called the ways of coordination."""


def load_config(path: Path | None, environ: Mapping[str, str], overrides: Mapping[str, str]) -> Config:
    """Read the file (None: none), `SENDWORTHY_…` of `environ`, and flags by key (`{"mode": "shadow"}`).

    Relative paths of the file, and default ones, are relative to the file. Raises ConfigError.
    """
    found: list[_Mistake] = []
    source = _read(path, found)
    layers = Layers(source.data)
    for override in [*variables(environ), *flags(overrides)]:
        _apply(override, layers, found)
    problems = _Problems(replace(source, data=layers.values), layers, found)
    outdated = tuple(_brought_up_to_date(layers, problems))
    config = _validated(layers.values, problems, outdated)
    _check_zenoh(layers.values, problems)
    specs = _specs_path(source.path.parent, layers, problems)
    if config is None or problems.found:
        raise ConfigError(problems.sorted())
    recordings = _recordings(source.path.parent, layers, environ, config.record.folder)
    return config.model_copy(
        update={
            "specs": config.specs.model_copy(update={"path": specs}),
            "record": config.record.model_copy(update={"folder": recordings}),
        }
    )


_Mistake = tuple[int, str]
"""The line of the file, and what is wrong there."""


@dataclass(frozen=True, slots=True)
class _Problems:
    """Collects mistakes in the merged values of `layers`; those of the file come first, by line."""

    source: TomlSource
    layers: Layers
    found: list[_Mistake]

    def at(self, path: KeyPath, message: str) -> None:
        """Add a mistake in the merged values, where it was made."""
        self.found.append(self.located(path, message))

    def located(self, path: KeyPath, message: str) -> _Mistake:
        """Return a message with the place in the merged values that it is about."""
        origin = self.layers.origin(path)
        if origin is None:
            problem = self.source.problem(path, message)
            return problem.line or 0, str(problem)
        label = self.source.label(path)
        place = "" if origin == f"--{label}" else f"{label}: "
        return _AFTER_THE_FILE, f"{origin}: {place}{message}"

    def sorted(self) -> tuple[str, ...]:
        return tuple(text for _, text in sorted(self.found, key=lambda problem: problem[0]))


_AFTER_THE_FILE = 1 << 30


def _read(path: Path | None, found: list[_Mistake]) -> TomlSource:
    """Read the file; without one, nothing is set and relative paths are relative to the working directory."""
    if path is None:
        return TomlSource(Path("sendworthy.toml"), {})
    try:
        return TomlSource.read(path)
    except TomlError as error:
        found.append((0, str(error)))
        return TomlSource(path, {})


def _apply(override: Override, layers: Layers, found: list[_Mistake]) -> None:
    """Lay a variable or flag on top, if it names a setting or something inside an open table."""
    setting = SETTINGS.get(override.path)
    inside = next((s for s in SETTINGS.values() if s.takes_table and override.path[: len(s.path)] == s.path), None)
    if setting is None and inside is None:
        key = ".".join(override.path)
        suggestion = hint(key, (s.key for s in SETTINGS.values()), "known keys")
        found.append((_AFTER_THE_FILE, f"{override.origin}: unknown key {key}{suggestion}"))
    else:
        layers.put(override, takes_text=setting is not None and setting.takes_text)


def _brought_up_to_date(layers: Layers, problems: _Problems) -> Iterator[str]:
    """Give values that older versions had the ones that they mean now; yield what to tell of each."""
    section = layers.values.get(COORDINATION[0])
    before = section.get(COORDINATION[1]) if isinstance(section, dict) else None
    if isinstance(section, dict) and isinstance(before, str) and before in RENAMED:
        section[COORDINATION[1]] = now = RENAMED[before]
        yield problems.located(COORDINATION, f'"{before}" is called "{now}" now: please write that')[1]


def _validated(values: Mapping[str, Any], problems: _Problems, outdated: tuple[str, ...]) -> Config | None:
    try:
        return Config.model_validate(values, context=outdated)
    except ValidationError as error:
        schema = Config.model_json_schema()
        for detail in error.errors(include_url=False):
            place = Place.find(schema, detail["loc"], detail["type"])
            problems.at(place.path, message_of(detail, place))
        return None


def _check_zenoh(values: Mapping[str, Any], problems: _Problems) -> None:
    for path, table in _zenoh_tables(values):
        from proxy.config_zenoh import zenoh_problems  # noqa: PLC0415 - few configurations need it

        for inner, message in zenoh_problems(table):
            problems.at((*path, *inner), message)


def _zenoh_tables(values: Mapping[str, Any]) -> Iterator[tuple[tuple[str, ...], Mapping[str, Any]]]:
    for setting in SETTINGS.values():
        section = values.get(setting.path[0])
        table = section.get(setting.path[-1]) if isinstance(section, Mapping) else None
        if setting.takes_table and isinstance(table, Mapping):
            yield setting.path, table


def _recordings(folder: Path, layers: Layers, environ: Mapping[str, str], path: Path) -> Path:
    """Resolve `record.folder`; by default recordings are where systemd has a place for what its service keeps."""
    state = environ.get("STATE_DIRECTORY")
    if state and "folder" not in layers.values.get(RECORDINGS[0], {}):
        return Path(state) / path
    return path if layers.origin(RECORDINGS) else folder / path


def _specs_path(folder: Path, layers: Layers, problems: _Problems) -> Path:
    """Resolve `specs.path`. A file must exist; a folder may come later: until then there are no specs."""
    section = layers.values.get(SPECS[0])
    given = section.get(SPECS[1]) if isinstance(section, Mapping) else None
    if not isinstance(given, str):
        return folder / SpecsConfig().path
    path = Path(given) if layers.origin(SPECS) else folder / given
    if path.suffix == ".toml" and not holds_specs(path) and not path.is_dir():
        problems.at(SPECS, f"{path} does not exist")
    return path
