"""The files of the configuration: the main one, and those of the folder `conf.d` beside it, laid upon it by name."""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from proxy.config_layers import KeyPath, deep_merge
from utility_specs.errors import SpecProblem, TomlError
from utility_specs.loader import spec_files
from utility_specs.toml_source import TomlSource

STANDARD = Path("/etc/sendworthy/sendworthy.toml")
"""Where a robot has its configuration."""
FURTHER = "conf.d"
"""The folder beside the main file."""


def standard(given: Path | None) -> Path | None:
    """Return the file that was given, else the standard one if it is there, else None."""
    try:
        return given if given or not STANDARD.exists() else STANDARD
    except OSError:  # who may not look is told when it is read
        return STANDARD


@dataclass(frozen=True, slots=True)
class ConfigFiles:
    """The files in their order, each on top of the one before. Without a main file there is an empty one.

    `unread` are the problems of those that could not be read; they count as empty.
    """

    sources: tuple[TomlSource, ...]
    unread: tuple[SpecProblem, ...] = ()

    @classmethod
    def read(cls, path: Path | None) -> Self:
        """Read the main file and what is beside it; never raises."""
        if path is None:
            return cls((TomlSource(Path("sendworthy.toml"), {}),))
        sources: list[TomlSource] = []
        unread: list[SpecProblem] = []
        for file in (path, *_further(path, unread)):
            try:
                sources.append(TomlSource.read(file))
            except TomlError as error:
                sources.append(TomlSource(file, {}))
                unread += error.problems
        return cls(tuple(sources), tuple(unread))

    @property
    def folder(self) -> Path:
        """Where relative paths begin, whichever file they stand in: the folder of the main file."""
        return self.sources[0].path.parent

    @property
    def values(self) -> dict[str, Any]:
        """What all files together say."""
        merged: dict[str, Any] = {}
        for source in self.sources:
            merged = deep_merge(merged, source.data)
        return merged

    def number_of(self, file: Path) -> int:
        """Return which of the files it is, for sorting."""
        return next((number for number, source in enumerate(self.sources) if source.path == file), 0)

    def source_of(self, path: KeyPath, values: Mapping[str, Any]) -> TomlSource:
        """Return the file that a key of the merged `values` comes from; for one that none has, where its table is."""
        depths = [_depth(source.data, values, path) for source in self.sources]
        deepest = max(depths)
        return next(source for source, depth in zip(self.sources[::-1], depths[::-1], strict=True) if depth == deepest)

    def line_of(self, path: KeyPath, values: Mapping[str, Any]) -> tuple[Path, int | None] | None:
        """Return the file and the line that a key of the merged `values` comes from; None: no file has it."""
        source = self.source_of(path, values)
        found = _depth(source.data, values, path) == len(path)
        return (source.path, source.line_of(path)) if found else None

    def problem(self, path: KeyPath, message: str, values: Mapping[str, Any]) -> SpecProblem:
        """Return a problem at a key of the merged `values`, with the file and the line where it stands."""
        source = self.source_of(path, values)
        label = TomlSource(source.path, dict(values)).label(path)
        return SpecProblem(source.path, source.line_of(path), label, message)


def watched(path: Path) -> Iterator[Path]:
    """Yield the main file and the folder beside it."""
    yield path
    yield path.parent / FURTHER


def _further(path: Path, unread: list[SpecProblem]) -> list[Path]:
    """Return the files of `conf.d`; one that cannot be looked into is a problem."""
    folder = path.parent / FURTHER
    try:
        return spec_files(folder) if folder.is_dir() else []
    except OSError as error:
        unread.append(SpecProblem(folder, None, "", f"cannot be read: {error.strerror}"))
        return []


def _depth(data: Any, values: Any, path: KeyPath) -> int:
    """Return how much of a path there is in `data`, as far as there is a table where the merged `values` have one."""
    for depth, part in enumerate(path):
        with suppress(KeyError, IndexError, TypeError):
            data, values = data[part], values[part]
            if isinstance(data, Mapping) == isinstance(values, Mapping):
                continue
        return depth
    return len(path)
