"""Checks `[app.zenoh]` and `[mesh.zenoh]` against what Zenoh knows: mistakes are found before the start."""

import json
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import zenoh

from proxy.config_secrets import without_secrets
from utility_specs.suggestions import hint

ZenohPath = tuple[str, ...]

_FILES = ("_file", "_certificate", "_private_key")
"""How the keys end whose values are paths of files."""
_WORDS = re.compile(r'(?:msg: |Str\()"(?P<message>(?:[^"\\]|\\.)*)"')


def zenoh_problems(table: Mapping[str, Any], path: ZenohPath = ()) -> Iterator[tuple[ZenohPath, str]]:
    """Yield the place and the message of every mistake in a part of a Zenoh configuration."""
    for key, value in table.items():
        here = (*path, key)
        refusal = _refusal(here, value)
        if refusal is None:
            yield from _missing_files(here, value)
            continue
        within = list(zenoh_problems(value, here)) if isinstance(value, Mapping) and _knows(here) else []
        yield from within or [(here, refusal)]


def with_places(table: Mapping[str, Any], folder: Path, beside: Callable[[ZenohPath], bool]) -> dict[str, Any]:
    """Return a part of a Zenoh configuration with the paths of files in a folder that are `beside` it."""
    return {key: _placed(value, (key,), folder, beside) for key, value in table.items()}


def _placed(value: Any, path: ZenohPath, folder: Path, beside: Callable[[ZenohPath], bool]) -> Any:
    if isinstance(value, Mapping):
        return {key: _placed(inner, (*path, key), folder, beside) for key, inner in value.items()}
    named = isinstance(value, str) and value and path[-1].endswith(_FILES)
    return str(folder / value) if named and value == without_secrets(value) and beside(path) else value


def _missing_files(path: ZenohPath, value: Any) -> Iterator[tuple[ZenohPath, str]]:
    """Yield files that are named and not there. Zenoh would say so when it starts, and name neither file nor key."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _missing_files((*path, key), inner)
    elif path[-1].endswith(_FILES) and isinstance(value, str):
        with suppress(OSError):  # who may not look whether it is there cannot say that it is not
            if not Path(value).exists():
                yield path, f"{without_secrets(value)} does not exist"


def _refusal(path: ZenohPath, value: Any) -> str | None:
    """Say why Zenoh refuses a value; None when it takes it."""
    try:
        zenoh.Config().insert_json5("/".join(path), json.dumps(value, default=str))
    except zenoh.ZError as error:
        words = _WORDS.search(str(error))
        # Zenoh ends its errors with places in its own source.
        message = (words["message"].replace("\\", "") if words else str(error)).split(" at /")[0]
    else:
        return None
    if not _knows(path):
        return "unknown key of Zenoh" + hint(path[-1], _siblings(path), "known keys")
    return f"Zenoh refuses it: {message}"


def _knows(path: ZenohPath) -> bool:
    return path[-1] in _siblings(path)


def _siblings(path: ZenohPath) -> list[str]:
    """Return the keys that Zenoh knows where the last key of `path` is."""
    known = json.loads(zenoh.Config().get_json("/".join(path[:-1]))) if path[1:] else _TOP
    return list(known) if isinstance(known, Mapping) else []


_TOP = json.loads(str(zenoh.Config()))
