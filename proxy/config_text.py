"""A configuration with the origins of its values, for people as TOML, for programs as JSON."""

import json
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict
from typing import Any

from proxy.config_origins import Entry

_COLUMN = 48
"""Where origins begin behind values that are short enough."""
_BARE = re.compile(r"[A-Za-z0-9_-]+")


def toml(entries: Iterable[Entry]) -> Iterator[str]:
    """Yield the lines of a configuration that says the same, each value with its origin as a comment."""
    table: tuple[str, ...] = ()
    for entry in entries:
        if entry.table != table:
            table = entry.table
            yield from ("", f"[{_key(table)}]")
        yield f"{_key(entry.path[len(table) :])} = {written(entry.value)}".ljust(_COLUMN) + f"  # {entry.origin}"


def data(entries: Iterable[Entry]) -> list[dict[str, Any]]:
    """Return the same as plain JSON data: an object for each key, in the order of the manual."""
    return [{"key": _key(entry.path), "value": entry.value, "origin": asdict(entry.origin)} for entry in entries]


def written(value: Any) -> str:
    """Return a value as TOML writes it on one line."""
    match value:
        case Mapping():
            return "{" + ", ".join(f"{_key((key,))} = {written(inner)}" for key, inner in value.items()) + "}"
        case list() | tuple():
            return "[" + ", ".join(map(written, value)) + "]"
        case str():
            return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
        case bool():
            return str(value).lower()
        case _:
            return repr(value)


def _key(path: Iterable[str]) -> str:
    return ".".join(part if _BARE.fullmatch(part) else written(part) for part in path)
