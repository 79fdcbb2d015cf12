"""Reads the configuration: defaults, under the files, under the environment, under the flags.

All mistakes are reported at once, each with its file, line and key, its variable or its flag.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from proxy.config import Config, SpecsConfig, settings
from proxy.config_files import ConfigFiles
from proxy.config_layers import Layers, Override, flags, variables
from proxy.errors import ConfigError
from proxy.fleet_token import read_token
from utility_specs.errors import SpecProblem
from utility_specs.loader import holds_specs
from utility_specs.suggestions import hint
from utility_specs.toml_lines import KeyPath
from utility_specs.toml_source import TomlSource
from utility_specs.wording import Place, message_of

SETTINGS = {setting.path: setting for setting in settings()}
SPECS = ("specs", "path")
RECORDINGS = ("record", "folder")
TOKEN_FILE = ("fleet", "token_file")
COORDINATION = ("planner", "coordination")
RENAMED = {"auto": "announce", "overhear": "announce", "shares": "split"}
"""What older versions called the ways of coordination."""


@dataclass(frozen=True, slots=True)
class Layered:
    """A configuration, and the layers that it is made of."""

    config: Config
    files: ConfigFiles
    layers: Layers


def load_config(path: Path | None, environ: Mapping[str, str], overrides: Mapping[str, str]) -> Config:
    """Read the file (None: none) and its `conf.d`, `SENDWORTHY_…` of `environ`, and flags (`{"mode": "shadow"}`).

    Relative paths of the files, and default ones, are relative to the main file. Raises ConfigError.
    """
    return load_layered(path, environ, overrides).config


def load_layered(path: Path | None, environ: Mapping[str, str], overrides: Mapping[str, str]) -> Layered:
    """Do the same, and return the layers too. Raises ConfigError."""
    files = ConfigFiles.read(path)
    layers = Layers(files.values)
    problems = _Problems(files, layers, [])
    for problem in files.unread:
        problems.found.append(problems.in_file(problem))
    for override in [*variables(environ), *flags(overrides)]:
        _apply(override, layers, problems)
    outdated = tuple(_brought_up_to_date(layers, problems))
    _place_files_of_zenoh(files.folder, layers)
    config = _validated(layers.values, problems, outdated)
    _check_zenoh(layers.values, problems)
    specs = _specs_path(files.folder, layers, problems)
    token_file = _token_file(files.folder, layers, problems)
    if config is None or problems.found:
        raise ConfigError(problems.sorted())
    recordings = _recordings(files.folder, layers, environ, config.record.folder)
    resolved = config.model_copy(
        update={
            "specs": config.specs.model_copy(update={"path": specs}),
            "record": config.record.model_copy(update={"folder": recordings}),
            "fleet": config.fleet.model_copy(update={"token_file": token_file}),
        }
    )
    return Layered(resolved, files, layers)


_Mistake = tuple[tuple[int, int], str]
"""The number of the file with the line, and what is wrong there."""
_AFTER_THE_FILES = (1 << 30, 0)


@dataclass(frozen=True, slots=True)
class _Problems:
    """Collects mistakes in the merged values of `layers`; those of the files come first, by line."""

    files: ConfigFiles
    layers: Layers
    found: list[_Mistake]

    def at(self, path: KeyPath, message: str) -> None:
        """Add a mistake in the merged values, where it was made."""
        self.found.append(self.located(path, message))

    def located(self, path: KeyPath, message: str) -> _Mistake:
        """Return a message with the place in the merged values that it is about."""
        origin = self.layers.origin(path)
        if origin is None:
            return self.in_file(self.files.problem(path, message, self.layers.values))
        label = TomlSource(Path(), self.layers.values).label(path)
        place = "" if origin == f"--{label}" else f"{label}: "
        return _AFTER_THE_FILES, f"{origin}: {place}{message}"

    def in_file(self, problem: SpecProblem) -> _Mistake:
        """Return a problem of a file as a mistake."""
        return (self.files.number_of(problem.file), problem.line or 0), str(problem)

    def sorted(self) -> tuple[str, ...]:
        return tuple(text for _, text in sorted(self.found, key=lambda mistake: mistake[0]))


def _apply(override: Override, layers: Layers, problems: _Problems) -> None:
    """Lay a variable or flag on top, if it names a setting or something inside an open table."""
    setting = SETTINGS.get(override.path)
    inside = next((s for s in SETTINGS.values() if s.takes_table and override.path[: len(s.path)] == s.path), None)
    if setting is None and inside is None:
        key = ".".join(override.path)
        suggestion = hint(key, (s.key for s in SETTINGS.values()), "known keys")
        problems.found.append((_AFTER_THE_FILES, f"{override.origin}: unknown key {key}{suggestion}"))
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
        _check_zenoh_mode(values, path, table.get("mode"), problems)


def _check_zenoh_mode(values: Mapping[str, Any], path: tuple[str, ...], mode: Any, problems: _Problems) -> None:
    """Refuse what a side cannot be: as a client Zenoh does not start, as a peer it does not bridge all applications."""
    side = values[path[0]]
    needed = "router" if path[0] == "app" or side.get("mode") == "client" else "peer"
    if isinstance(mode, str) and mode in {"router", "peer", "client"} - {needed}:
        other = "" if path[0] == "app" else "; mesh.mode says how robots meet"
        problems.at((*path, "mode"), f'must be "{needed}" if it is set: the daemon is that on this side{other}')


def _place_files_of_zenoh(folder: Path, layers: Layers) -> None:
    """Resolve the paths of certificates and the like that files name, as all others in them."""
    for path, table in _zenoh_tables(layers.values):
        from proxy.config_zenoh import with_places  # noqa: PLC0415 - few configurations need it

        def beside(inner: tuple[str, ...], path: tuple[str, ...] = path) -> bool:
            return layers.origin((*path, *inner)) is None

        section = layers.values[path[0]] | {path[-1]: with_places(table, folder, beside)}
        layers.values = layers.values | {path[0]: section}


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


def _token_file(folder: Path, layers: Layers, problems: _Problems) -> str:
    """Resolve `fleet.token_file`; there must be a token in it."""
    section = layers.values.get(TOKEN_FILE[0])
    given = section.get(TOKEN_FILE[1]) if isinstance(section, Mapping) else None
    if not isinstance(given, str) or not given:
        return ""
    path = Path(given) if layers.origin(TOKEN_FILE) else folder / given
    try:
        read_token(path)
    except ValueError as error:
        problems.at(TOKEN_FILE, str(error))
    return str(path)


def _specs_path(folder: Path, layers: Layers, problems: _Problems) -> Path:
    """Resolve `specs.path`. A file must exist; a folder may come later: until then there are no specs."""
    section = layers.values.get(SPECS[0])
    given = section.get(SPECS[1]) if isinstance(section, Mapping) else None
    if not isinstance(given, str) or "\0" in given:
        return folder / SpecsConfig().path
    path = Path(given) if layers.origin(SPECS) else folder / given
    if path.suffix == ".toml" and not holds_specs(path) and not path.is_dir():
        problems.at(SPECS, f"{path} does not exist")
    return path
