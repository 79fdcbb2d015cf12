"""Key expressions that nearly cover a key, and which chunks are in the way."""

from collections.abc import Iterable
from dataclasses import dataclass
from difflib import SequenceMatcher
from functools import cache, lru_cache

import zenoh

from utility_specs.key_formats import KeyFormat
from utility_specs.suggestions import quoted

FAR = 2.0
"""What differs by more is not near: two chunks too many, too few or of another name."""
BESIDE = 0.15
"""What differs by so much more than the nearest is not told beside it."""
ALIKE = 0.6
"""Chunks that are less alike have nothing in common: short ones often share a letter."""
MISSING = (1.0, 0.95)
"""What a missing chunk counts, and one that may be any: which of two is missing is told by the names."""
LONGEST = 64
"""Chunks of keys and expressions that are compared."""


@dataclass(frozen=True, slots=True)
class Near:
    """A key expression as it is written, and what would have to be otherwise in the key."""

    expression: str
    differences: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Apart:
    cost: float
    differences: tuple[str, ...] = ()

    def __lt__(self, other: "_Apart") -> bool:
        return self.cost < other.cost

    def more(self, cost: float, difference: str = "") -> "_Apart":
        return _Apart(self.cost + cost, (difference, *self.differences) if difference else self.differences)


def nearest(key: str, expressions: Iterable[str], most: int) -> tuple[Near, ...]:
    """Return the expressions that come nearest to covering a key that none covers, the nearest first."""
    chunks = key.split("/")
    apart = [(_apart(chunks, KeyFormat.parse(each).expression.split("/")), each) for each in expressions]
    near = sorted((each for each in apart if each[0].cost < FAR), key=lambda each: each[0].cost)[:most]
    furthest = near[0][0].cost + BESIDE if near else 0.0
    return tuple(Near(expression, found.differences) for found, expression in near if found.cost <= furthest)


def _apart(key: list[str], expression: list[str]) -> _Apart:
    """Return by what a key misses an expression: the least that has to be changed, chunk by chunk."""
    named = sum("*" not in chunk for chunk in expression)
    if max(len(key), len(expression)) > LONGEST:
        return _Apart(FAR)

    @cache
    def rest(i: int, j: int) -> _Apart:
        if i == len(key) and j == len(expression):
            return _Apart(0.0)
        ways = []
        if j < len(expression) and expression[j] == "**":
            ways.append(rest(i, j + 1))
            if i < len(key):
                ways.append(rest(i + 1, j))
        elif j < len(expression):
            ways.append(rest(i, j + 1).more(MISSING[expression[j] == "*"], f"{quoted(expression[j])} is missing"))
            if i < len(key):
                ways.append(rest(i + 1, j + 1).more(*_unlike(key[i], expression[j])))
        if i < len(key):
            ways.append(rest(i + 1, j).more(1.0, f"{quoted(key[i])} is one chunk too many"))
        return min(ways)

    found = rest(0, 0)
    return found if found.cost < max(1, named) else _Apart(FAR)  # or nothing that has a name is alike


@lru_cache(maxsize=4096)  # of thousands of expressions most have the same chunks
def _unlike(chunk: str, wanted: str) -> tuple[float, str]:
    """Return how unlike a chunk is to what is wanted, from 0 to 1, and say so."""
    if zenoh.KeyExpr(wanted).includes(zenoh.KeyExpr(chunk)):
        return 0.0, ""
    likeness = SequenceMatcher(None, chunk, wanted).ratio()
    return 1.0 - likeness * (likeness >= ALIKE), f"{quoted(chunk)} is not {quoted(wanted)}"
