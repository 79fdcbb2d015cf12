"""The layers of the configuration: what the files say, under the environment, under the flags.

Variables and flags are text, read as TOML values (`true`, `500`, `["tcp/10.0.0.2:7500"]`); what is no
TOML is a string, and so is everything for a setting that takes text: `--robot 7` names the robot "7".
"""

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

PREFIX = "SENDWORTHY_"
KeyPath = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Override:
    """One value from outside the files; `origin` is the variable or flag, as a message names it."""

    path: tuple[str, ...]
    text: str
    origin: str


@dataclass(slots=True)
class Layers:
    """The merged values, and where each of them came from when not from a file."""

    values: dict[str, Any]
    origins: dict[KeyPath, str] = field(default_factory=dict)

    def put(self, override: Override, *, takes_text: bool) -> None:
        """Lay `override` on top. Where a file has a value in place of a table, the file's mistake stays."""
        value = read_value(override.text, takes_text=takes_text)
        nested: Any = value
        for key in reversed(override.path):
            nested = {key: nested}
        self.values = deep_merge(self.values, nested)
        for path in leaves(value, override.path):
            self.origins[path] = override.origin

    def origin(self, path: KeyPath) -> str | None:
        """Return the variable or flag that set `path` or what it is a part of; None: a file did, or none."""
        return next((name for known, name in self.origins.items() if path[: len(known)] == known), None)


def variables(environ: Mapping[str, str]) -> Iterator[Override]:
    """Yield what the environment sets: `SENDWORTHY_PLANNER__ITERATIONS` is `planner.iterations`."""
    for name, text in sorted(environ.items()):
        if name.startswith(PREFIX):
            path = tuple(name.removeprefix(PREFIX).lower().split("__"))
            yield Override(path, text, name)


def flags(given: Mapping[str, str]) -> Iterator[Override]:
    """Yield what the command line sets: `--planner.iterations` is `planner.iterations`."""
    for key, text in given.items():
        yield Override(tuple(key.split(".")), text, f"--{key}")


def read_value(text: str, *, takes_text: bool) -> Any:
    """Read `text` as one TOML value, or as the string that it is."""
    try:
        document = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):  # also for more digits, or brackets, than Python reads
        return text
    value = document["value"]
    one_value = len(document) == 1
    return value if one_value and (isinstance(value, str) or not takes_text) else text


def deep_merge(under: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """Merge two trees of tables; `over` wins, but a table never replaces what is no table."""
    merged = dict(under)
    for key, value in over.items():
        below = merged.get(key)
        if isinstance(value, Mapping) and key in merged:
            if isinstance(below, Mapping):
                merged[key] = deep_merge(below, value)
        else:
            merged[key] = value
    return merged


def leaves(value: Any, path: KeyPath) -> Iterator[KeyPath]:
    """Yield the path of everything in `value` that is no table."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from leaves(inner, (*path, key))
    else:
        yield path
