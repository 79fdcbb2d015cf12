"""Frozen dataclasses as JSON and back, to the last bit.

A number that is not finite is the text "inf", "-inf" or "nan", for JSON has none. Specs are told by their generation.
What a later version adds to a class is ignored, and what an earlier one lacked takes its default.
"""

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from enum import StrEnum
from functools import cache
from operator import attrgetter
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from proxy.recording.errors import RecordingError
from utility_specs import Specs

Reading = Callable[[Any], Any]
"""Makes a value of plain JSON data; raises RecordingError for what is none."""

_SCHEMA_TYPES: dict[Any, str] = {
    bool: "boolean",
    int: "integer",
    float: "number",
    str: "string",
    bytes: "string",
    NoneType: "null",
}


def text(data: Mapping[str, Any]) -> str:
    """Return plain data, and dataclasses in it, as one line of JSON."""
    try:
        return _strict(data)
    except ValueError:  # a number that is not finite
        return _strict(_finite(data))


def plain(value: Any) -> dict[str, Any]:
    """Return a dataclass as a table of its fields; what is inside of them stays as it is."""
    kind: Any = type(value)
    names, values = _fields(kind)
    return dict(zip(names, values(value), strict=True))


def read(kind: Any, data: Any) -> Any:
    """Return a value of this type from plain JSON data; raises RecordingError."""
    return reading(kind)(data)


def reading(kind: Any) -> Reading:
    """Return what reads values of a type, which may be a dataclass with others inside."""
    return _reading(kind)


@cache
def _reading(kind: Any) -> Reading:
    if is_dataclass(kind):
        return _class_reading(kind)
    origin, inside = get_origin(kind), get_args(kind)
    if origin in (Union, UnionType):
        return _union_reading(inside)
    if origin is tuple:
        return _tuple_reading(inside)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return _table_reading(reading(inside[1]))
    if origin is Literal:
        return _literal_reading(inside)
    return _scalar_reading(kind)


def schema(kind: type, **extra: Mapping[str, Any]) -> dict[str, Any]:
    """Return the JSON schema of a dataclass, with further properties."""
    hints = get_type_hints(kind)
    properties = {field.name: _schema_of(hints[field.name]) for field in fields(kind)}
    description = (kind.__doc__ or "").strip()
    return {"type": "object", "title": kind.__name__, "description": description, "properties": properties | extra}


def _default(value: Any) -> Any:
    """Return what JSON has no word for as something that it has."""
    if isinstance(value, Specs):
        return value.generation
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, Mapping):
        return dict(value)
    return plain(value)


_strict = json.JSONEncoder(
    ensure_ascii=False, check_circular=False, allow_nan=False, separators=(",", ":"), default=_default
).encode


def _finite(value: Any) -> Any:
    """Return plain data in which numbers that are not finite are texts."""
    if isinstance(value, float) and not math.isfinite(value):
        return repr(value)
    if isinstance(value, str | int | float | NoneType):
        return value
    if isinstance(value, Mapping):
        return {name: _finite(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(each) for each in value]
    return _finite(_default(value))


@cache
def _fields(kind: type) -> tuple[tuple[str, ...], Callable[[Any], tuple[Any, ...]]]:
    """Return the names of a dataclass's fields, and what takes their values."""
    names = tuple(field.name for field in fields(kind))
    if len(names) > 1:
        return names, attrgetter(*names)
    return names, lambda value: tuple(getattr(value, name) for name in names)


def _class_reading(kind: Any) -> Reading:
    hints = get_type_hints(kind)
    known = [(each.name, reading(hints[each.name]), _optional(each)) for each in fields(kind) if each.init]

    def made(data: Any) -> Any:
        if not isinstance(data, dict):
            raise RecordingError(f"{data!r:.80} is no {kind.__name__}")
        values = {}
        for name, of, optional in known:
            if name in data:
                values[name] = of(data[name])
            elif not optional:
                raise RecordingError(f'a {kind.__name__} without "{name}"')
        try:
            return kind(**values)
        except ValueError as error:
            raise RecordingError(f"no {kind.__name__}: {error}") from None

    return made


def _optional(field: Field[Any]) -> bool:
    return field.default is not MISSING or field.default_factory is not MISSING


def _union_reading(kinds: tuple[Any, ...]) -> Reading:
    (kind,) = (each for each in kinds if each is not NoneType)
    of = reading(kind)
    return lambda data: None if data is None else of(data)


def _tuple_reading(inside: tuple[Any, ...]) -> Reading:
    if inside[-1] is Ellipsis:
        of = reading(inside[0])
        return lambda data: tuple([of(each) for each in _list(data)])
    parts = tuple(reading(each) for each in inside)

    def made(data: Any) -> Any:
        if len(_list(data)) != len(parts):
            raise RecordingError(f"{data!r:.80} are not {len(parts)} values")
        return tuple(of(each) for of, each in zip(parts, data, strict=True))

    return made


def _list(data: Any) -> list[Any]:
    if not isinstance(data, list):
        raise RecordingError(f"{data!r:.80} is no list")
    return data


def _table_reading(of: Reading) -> Reading:
    def made(data: Any) -> Any:
        if not isinstance(data, dict):
            raise RecordingError(f"{data!r:.80} is no table")
        return {name: of(each) for name, each in data.items()}

    return made


def _literal_reading(words: tuple[Any, ...]) -> Reading:
    def made(data: Any) -> Any:
        if data not in words:
            raise RecordingError(f"{data!r:.80} is none of {', '.join(map(str, words))}")
        return data

    return made


def _scalar_reading(kind: Any) -> Reading:
    if kind is float:
        return _number
    if kind is bytes:
        return _bytes
    if isinstance(kind, type) and issubclass(kind, StrEnum):
        return _literal_of(kind)

    def made(data: Any) -> Any:
        if type(data) is not kind:
            raise RecordingError(f"{data!r:.80} is no {kind.__name__}")
        return data

    return made


def _literal_of(kind: type[StrEnum]) -> Reading:
    words = {str(each): each for each in kind}

    def made(data: Any) -> Any:
        if data not in words:
            raise RecordingError(f"{data!r:.80} is none of {', '.join(words)}")
        return words[data]

    return made


def _number(data: Any) -> Any:
    """Return a number as it was: a whole one where a fraction could be stays a whole one."""
    if type(data) in (float, int):
        return data
    if data in ("inf", "-inf", "nan"):
        return float(data)
    raise RecordingError(f"{data!r:.80} is no number")


def _bytes(data: Any) -> bytes:
    try:
        return bytes.fromhex(data)
    except (TypeError, ValueError):
        raise RecordingError(f"{data!r:.80} are no bytes in hexadecimal digits") from None


def _schema_of(kind: Any) -> dict[str, Any]:
    """Return the JSON schema of a type."""
    origin, inside = get_origin(kind), get_args(kind)
    if is_dataclass(kind) and kind is not Specs:
        return schema(kind)  # type: ignore[arg-type]
    if origin in (Union, UnionType):
        return _schema_of(next(each for each in inside if each is not NoneType))
    if origin is tuple:
        return {"type": "array", "items": _schema_of(inside[0]) if len(set(inside) - {Ellipsis}) == 1 else {}}
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return {"type": "object", "additionalProperties": _schema_of(inside[1])}
    return {"type": _SCHEMA_TYPES.get(kind, "string")}
