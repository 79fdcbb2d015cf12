"""Where each value of a configuration comes from: a default, a line of a file, a variable, a flag."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from proxy.config import settings
from proxy.config_layers import KeyPath, leaves
from proxy.config_loading import Layered
from proxy.config_secrets import without_secrets


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a value comes from: `kind` is default, file, variable or flag, `name` which of them."""

    kind: str
    name: str = ""
    line: int | None = None

    def __str__(self) -> str:
        return self.kind if not self.name else self.name if self.line is None else f"{self.name}:{self.line}"


@dataclass(frozen=True, slots=True)
class Entry:
    """One key with its value, without secrets. Of tables that are open for any key there is an entry for each."""

    path: tuple[str, ...]
    table: tuple[str, ...]
    """The table of the manual that it stands in."""
    value: Any
    origin: Origin


def entries(layered: Layered) -> Iterator[Entry]:
    """Yield every key in the order of the manual."""
    values = layered.config.model_dump(mode="json", by_alias=True)
    for setting in settings():
        inner = leaves(_at(values, setting.path), setting.path) if setting.takes_table else ()
        for path in tuple(map(_keys, inner)) or (setting.path,):
            value = without_secrets(_at(values, path), path)
            yield Entry(path, setting.path[:-1], value, _origin(layered, path))


def _origin(layered: Layered, path: KeyPath) -> Origin:
    named = layered.layers.origin(path)
    if named is not None:
        return Origin("flag" if named.startswith("--") else "variable", named)
    place: tuple[Path, int | None] | None = layered.files.line_of(path, layered.layers.values)
    return Origin("default") if place is None else Origin("file", str(place[0]), place[1])


def _keys(path: KeyPath) -> tuple[str, ...]:
    return tuple(map(str, path))


def _at(values: Any, path: tuple[str, ...]) -> Any:
    for name in path:
        values = values[name]
    return values
