"""Events and what followed as JSON, by msgspec: the same data as by `json_data`, in a fifth of the time or less.

msgspec writes `null` for a number that is not finite, too, and bytes in another way. So a line with more of these words
than values that are None is left to `json_data`, as is a class of which that cannot be told. Needs the extra `record`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from enum import StrEnum
from functools import cache
from operator import attrgetter
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from msgspec import MsgspecError
from msgspec.json import Encoder

from proxy.core.interface.events import Event

Counting = Callable[[Any], int]
"""Says how many values in a value are None."""
_SCALARS = (bool, int, float, str)
_encoder = Encoder(enc_hook=dict)  # what it does not know is a read-only table
_encode = _encoder.encode


class _UntoldError(Exception):
    """Of a class it cannot be told beforehand what msgspec makes of it."""


def line(event: Event, commands: Sequence[Any]) -> bytes | None:
    """Return an event with the commands that followed, as such or described; None where it is left to `json_data`."""
    try:
        made, followed = _told(event), list(map(_command, commands))
    except (_UntoldError, MsgspecError, TypeError, ValueError, OverflowError):
        return None
    return b'%b,"commands":[%b]}' % (made[:-1], b",".join(followed)) if followed else made


def told(kind: Any) -> bool:
    """Whether events or commands of a class are not left to `json_data` beforehand."""
    return _of_class(kind) is not None


def _command(command: Any) -> bytes:
    """Return a command as it stands in a line: behind its head, which says its class. Raises _UntoldError."""
    kind: Any = type(command)
    head, data = _head(kind), _told(command)
    return head + data[1:] if head and len(data) > len(b"{}") else head[:-1] + b"}" if head else data


@cache
def _head(kind: type) -> bytes:
    """Return what commands of a class begin with; nothing if they are described already. Raises _UntoldError."""
    if kind is dict:
        return b""
    if _of_class(kind) is None:
        raise _UntoldError
    return b'{"command":"%b",' % kind.__name__.encode()


def _told(value: Any) -> bytes:
    """Return an event or a command as JSON. Raises _UntoldError where that is not sure to be right."""
    kind: Any = type(value)
    count = _of_class(kind)
    if count is None:
        raise _UntoldError
    made: bytes = _encode(value)
    nulls = made.count(b"null")  # a text may have the word, too: then there is one more than there should be
    if nulls and nulls != count(value):
        raise _UntoldError
    return made


@cache
def _of_class(kind: type) -> Counting | None:
    """Return what counts None in events or commands of a class; None where that cannot be told."""
    if kind is dict:
        return lambda command: sum(each is None for each in command.values())
    try:
        return _counting(kind) or _never
    except _UntoldError:
        return None


def _never(_: Any) -> int:
    return 0


@cache
def _counting(kind: Any) -> Counting | None:
    """Return what counts None in values of a type; None where there never are any. Raises _UntoldError."""
    origin, inside = get_origin(kind), get_args(kind)
    if is_dataclass(kind):
        return _in_class(kind)
    if origin in (Union, UnionType):
        return _in_union(inside)
    if origin is tuple:
        return _in_all(list, {each for each in inside if each is not Ellipsis})
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return _in_all(lambda table: table.values(), {inside[1]})
    if origin is Literal or (isinstance(kind, type) and (kind in _SCALARS or issubclass(kind, StrEnum))):
        return None
    raise _UntoldError


def _in_class(kind: Any) -> Counting | None:
    hints = get_type_hints(kind)
    found = [(each.name, count) for each in fields(kind) if (count := _counting(hints[each.name])) is not None]
    if len(found) == 1:  # as of the samples of applications, which are most of what is written
        ((only, counting),) = found
        value_of = attrgetter(only)
        return lambda value: counting(value_of(value))
    return (lambda value: sum([count(getattr(value, name)) for name, count in found])) if found else None


def _in_union(kinds: tuple[Any, ...]) -> Counting | None:
    counts = [count for each in kinds if each is not NoneType and (count := _counting(each)) is not None]
    if NoneType not in kinds:
        if counts:  # it is not known of which kind a value is
            raise _UntoldError
        return None
    if len(counts) > 1:
        raise _UntoldError
    if not counts:
        return _is_none
    (count,) = counts
    return lambda value: value is None or count(value)


def _is_none(value: Any) -> bool:
    return value is None


def _in_all(parts: Callable[[Any], Any], kinds: set[Any]) -> Counting | None:
    counts = {count for each in kinds if (count := _counting(each)) is not None}
    if not counts:
        return None
    if len(kinds) > 1:
        raise _UntoldError
    (count,) = counts
    return lambda value: sum(map(count, parts(value)))
