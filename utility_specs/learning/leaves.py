"""The numbers and words in a document, each with the path under which a feature finds it."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np

from utility_specs.features.path import Path
from utility_specs.features.reading import Reduction

MOST = 32
"""Leaves of one document that are looked at."""
DEEPEST = 6
FEW = 4
"""Arrays of up to so many numbers are looked at one by one, longer ones by their least and greatest."""
LONGEST_TEXT = 40
LARGEST = 1e20
"""Numbers beyond it are nobody's measurements: times in nanoseconds are the largest."""


@dataclass(frozen=True, slots=True)
class Leaf:
    """A place in a document, and what is made of an array there."""

    path: Path
    reduce: Reduction | None = None


Shown = Leaf | str
"""A place in a document, or the name of a feature of images."""

Values = dict[Shown, float | str]
"""The numbers and short texts that a sample shows."""


def leaves(document: Any) -> Values:
    """Return the first numbers and short texts of a document, or of a message of ROS 2."""
    found: Values = {}
    for leaf, value in _walk(document, "", 0):
        found[leaf] = value
        if len(found) == MOST:
            break
    return found


def _walk(value: Any, path: str, depth: int) -> Iterator[tuple[Leaf, float | str]]:
    number = _number(value)
    if number is not None:
        yield Leaf(path), number
    elif isinstance(value, str):
        if path and 0 < len(value) <= LONGEST_TEXT and value.isprintable():
            yield Leaf(path), value
    elif isinstance(value, list | tuple | np.ndarray):
        yield from _array(value, path)
    elif depth < DEEPEST:
        for step, child in _children(value, path):
            yield from _walk(child, step, depth + 1)


def _array(values: Any, path: str) -> Iterator[tuple[Leaf, float | str]]:
    yield Leaf(path, "length"), float(len(values))
    if isinstance(values, np.ndarray) and values.dtype.itemsize == 1:
        return  # bytes
    numbers = _numbers(values)
    if numbers is not None and len(values) <= FEW:
        for index, number in enumerate(numbers):
            if math.isfinite(number):
                yield Leaf(f"{path}[{index}]"), number
    elif numbers is not None:
        yield from _extremes(numbers, path)
    else:
        yield from _elements(values, path)


def _elements(values: Any, path: str) -> Iterator[tuple[Leaf, float | str]]:
    """Yield the greatest of each number that the elements of an array have by the same name."""
    if not all(isinstance(value, Mapping) or is_dataclass(value) for value in values):
        return
    together: dict[str, list[float | None]] = {}
    for value in values:
        for step, child in _children(value, f"{path}[*]"):
            together.setdefault(step, []).append(_number(child))
    for step, found in together.items():
        numbers = [number for number in found if number is not None]
        if len(numbers) == len(found):
            yield Leaf(step, "max"), max(numbers)


def _extremes(numbers: "np.ndarray[Any, np.dtype[np.float64]]", path: str) -> Iterator[tuple[Leaf, float]]:
    finite = numbers[np.isfinite(numbers)]
    if finite.size and float(np.abs(finite).max()) < LARGEST:
        yield Leaf(path, "min"), float(finite.min())
        yield Leaf(path, "max"), float(finite.max())


def _numbers(values: Any) -> "np.ndarray[Any, np.dtype[np.float64]] | None":
    """Return an array of numbers and of nothing else; None for all other arrays."""
    if isinstance(values, np.ndarray):
        plain = values.ndim == 1 and values.dtype.kind in "biuf"
    else:
        plain = all(isinstance(value, bool | int | float) for value in values)
    try:
        return np.asarray(values, np.float64) if plain and len(values) else None
    except OverflowError:
        return None


def _number(value: Any) -> float | None:
    return float(value) if isinstance(value, bool | int | float) and abs(value) < LARGEST else None


def _children(value: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield what is in a table or a message by name, with the path to it."""
    if isinstance(value, Mapping):
        names = value.items()
    elif is_dataclass(value) and not isinstance(value, type):
        names = {each.name: getattr(value, each.name) for each in fields(value) if each.name != "__msgtype__"}.items()
    else:
        return
    for name, child in names:
        step = _step(name, first=not path)
        if step is not None:
            yield path + step, child


def _step(name: Any, *, first: bool) -> str | None:
    """Return a name as a path has it; None for what no path can name."""
    if isinstance(name, int) and not isinstance(name, bool) and 0 <= name < 10**9:
        return f"[{name}]"
    if not isinstance(name, str) or len(name) > LONGEST_TEXT or not name.isprintable() or '"' in name:
        return None
    if not name or any(sign in name for sign in ".[]"):
        return f'["{name}"]'
    return name if first else f".{name}"
