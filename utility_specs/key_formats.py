"""Key expressions whose chunks may have names, as in Zenoh's key formats: `robot/${robot:*}/camera/${camera:*}`.

A chunk that is captured can be used by its name in expressions: as text when it is compared with text, else as the
number that is written there.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import zenoh

from utility_specs.suggestions import described, quoted

_CAPTURE = re.compile(r"\$\{(\w*):([^{}]*)\}")
_NUMBER = re.compile(r"[+-]?[0-9]{1,300}(\.[0-9]{1,300})?([eE][+-]?[0-9]{1,3})?")

LONGEST = 1024
"""Characters of the longest key expression."""
MOST = 16
"""Chunks that one captures at most."""
MOST_WILD = 3
"""`**` or `$*` in one at most: with each, Zenoh takes as many times longer as there are chunks or letters."""


def as_text(capture: str) -> str:
    """Return the name under which expressions find a captured chunk as text."""
    return f"{capture}:text"


@dataclass(frozen=True, slots=True)
class KeyFormat:
    """A key expression in canonical form, and the places of the chunks it captures.

    Places count from the first chunk, or backwards from the last one behind `**`.
    """

    expression: str
    captures: tuple[tuple[str, int], ...] = ()

    @classmethod
    def parse(cls, written: str) -> Self:
        """Return what is written; raises ValueError, which says what is wrong."""
        if len(written) > LONGEST:
            raise ValueError(f"is longer than {LONGEST} characters")
        chunks = written.split("/")
        if chunks.count("**") > MOST_WILD:
            raise ValueError(f"has more than {MOST_WILD} **")
        if written.count("$*") > MOST_WILD:
            raise ValueError(f"has more than {MOST_WILD} $*")
        plain = [_plain(chunk) for chunk in chunks]
        captures = tuple(
            (found[1], place) for place, chunk in enumerate(chunks) if (found := _CAPTURE.fullmatch(chunk))
        )
        if not captures:
            return cls(_key_expression(written))
        names = [name for name, _ in captures]
        if len(names) > MOST:
            raise ValueError(f"captures more than {MOST} chunks")
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"captures {quoted(name)} twice")
        if plain.count("**") > 1:
            raise ValueError("has more than one ** beside what it captures: which chunk is meant cannot be told")
        far = plain.index("**") if "**" in plain else len(plain)
        placed = tuple((name, place if place < far else place - len(plain)) for name, place in captures)
        return cls(_key_expression("/".join(plain), canonical=False), placed)

    def captured(self, key: str) -> dict[str, str]:
        """Return the captured chunks of a key that the expression includes, by name."""
        chunks = key.split("/") if self.captures else []
        return {name: chunks[place] for name, place in self.captures}


def values_of(captured: Mapping[str, str]) -> dict[str, float | str]:
    """Return what expressions know of captured chunks: their text and, where they are one, their number."""
    values: dict[str, float | str] = {as_text(name): chunk for name, chunk in captured.items()}
    for name, chunk in captured.items():
        if _NUMBER.fullmatch(chunk) and math.isfinite(number := float(chunk)):
            values[name] = number
    return values


def _plain(chunk: str) -> str:
    """Return what Zenoh matches in place of a chunk; raises ValueError for a capture that is none."""
    found = _CAPTURE.fullmatch(chunk)
    if found is None:
        if "{" in chunk or "}" in chunk:
            meant = re.search(r"\{(\w+)", chunk)
            example = f"${{{meant[1] if meant else 'name'}:*}}"
            raise ValueError(f"{quoted(chunk)} captures nothing; a capture is a whole chunk, such as {quoted(example)}")
        return chunk
    name, pattern = found.groups()
    if not name:
        raise ValueError(f'{quoted(chunk)} has no name; write "${{name:{pattern}}}"')
    if pattern == "**" or "*" not in pattern:
        raise ValueError(f'{quoted(chunk)} does not stand for one chunk that varies; write "${{{name}:*}}"')
    return pattern


def _key_expression(text: str, *, canonical: bool = True) -> str:
    if text.strip("/") != text and text.strip("/"):
        right = quoted(text.strip("/"))
        raise ValueError(f"{described(text)} is not a key expression: write {right}, without a slash at its ends")
    try:
        return str(zenoh.KeyExpr(text) if canonical else zenoh.KeyExpr.autocanonize(text))
    except zenoh.ZError as error:
        cause = re.sub(r"^Invalid Key Expr `.*`: | at /\S*$", "", str(error).rstrip("."), flags=re.DOTALL)
        raise ValueError(f"{described(text)} is not a key expression: {cause.rstrip('.')}") from None
