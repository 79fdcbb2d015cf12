"""Names for what was found: of information types and of features."""

import keyword
import re
from collections.abc import Collection, Sequence

from utility_specs.expressions import CONSTANTS, FUNCTIONS

LONGEST = 48


def type_name(words: Sequence[str], telling: int, taken: Collection[str]) -> str:
    """Return a name of the last words of a key, of as many as it takes to be none of those `taken`."""
    name = ""
    for count in range(min(max(1, telling), len(words)), len(words) + 1):
        name = re.sub(r"[^\w.-]+", "_", "_".join(words[-count:]), flags=re.ASCII).strip("_.-")[-LONGEST:].lstrip(".-")
        if name and name not in taken:
            return name
    return _numbered(name or "stream", taken)


def feature_name(path: str, suffix: str, taken: Collection[str]) -> str:
    """Return a name of the last names of a path that expressions can use and that is none of those `taken`."""
    words, suffix = _words(path), "_".join(_words(suffix))
    name = ""
    for word in reversed(words):
        name = (f"{word}_{name}" if name else word)[-LONGEST:]
        whole = _identifier(f"{name}_{suffix}" if suffix else name)
        if not word.isdigit() and whole not in taken and not _reserved(whole):
            return whole
    return _numbered(_identifier("_".join(filter(None, (name or "value", suffix)))), taken)


def _words(text: str) -> list[str]:
    return [word for word in re.split(r"[^A-Za-z0-9_]+", text) if word.strip("_")]


def _identifier(name: str) -> str:
    return f"v{name}" if name[:1].isdigit() else name


def _reserved(name: str) -> bool:
    return name in CONSTANTS or name in FUNCTIONS or keyword.iskeyword(name)


def _numbered(name: str, taken: Collection[str]) -> str:
    number = 1
    while f"{name}_{number}" in taken:
        number += 1
    return f"{name}_{number}"
