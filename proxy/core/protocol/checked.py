"""The values of a message as they are read: each function returns one, or raises `MalformedWireError`."""

import math
from typing import Any

from proxy.core.protocol.envelope import MalformedWireError
from proxy.core.protocol.fixed import CODES, LARGEST_SINGLE, decoded, ticks
from proxy.core.protocol.tuning import TUNING


def array(value: object, most: int = TUNING.digest_bytes) -> list[Any]:
    """Return a list of at most `most` values."""
    if not isinstance(value, list):
        raise MalformedWireError(f"{value!r:.80} is no list")
    if len(value) > most:
        raise MalformedWireError(f"{len(value)} entries are more than {most}")
    return value


def entries(items: list[Any], least: int, most: int) -> list[list[Any]]:
    """Return lists of `least` to `most` fields each."""
    if not all(isinstance(item, list) and least <= len(item) <= most for item in items):
        raise MalformedWireError(f"an entry that is no list of {least} to {most}")
    return items


def records(items: list[Any], length: int) -> list[list[Any]]:
    """Return the records of `length` fields that follow each other in a list."""
    if len(items) % length:
        raise MalformedWireError(f"{len(items)} fields of records of {length}")
    return [items[i : i + length] for i in range(0, len(items), length)]


def text(value: object) -> str:
    """Return a text."""
    if not isinstance(value, str):
        raise MalformedWireError(f"{value!r:.80} is no string")
    return value


def is_key(text: str) -> bool:
    """Whether others take a text for the key of a sample: no key expression, and not too long."""
    return bool(text) and "*" not in text and len(text.encode()) <= TUNING.key_bytes


def key(value: object) -> str:
    """Return the key of a sample."""
    found = text(value)
    if not is_key(found):
        raise MalformedWireError(f"{found:.80} is no key of a sample")
    return found


def tag(value: object) -> str:
    """Return the tag of a robot: eight hexadecimal digits travel as a number."""
    return value if isinstance(value, str) else f"{count(value, 2**32):08x}"


def zid(value: object) -> str:
    """Return the id of a session: hexadecimal digits travel as bytes."""
    return value.hex() if isinstance(value, bytes) else text(value)


def count(value: object, most: int = TUNING.count) -> int:
    """Return a whole number from 0 to `most`."""
    if type(value) is not int or not 0 <= value <= most:
        raise MalformedWireError(f"{value!r:.80} is no count")
    return value


def time(value: object) -> int:
    """Return a time, or the distance between two [ticks]."""
    if type(value) is not int or abs(value) > ticks(TUNING.time):
        raise MalformedWireError(f"{value!r:.80} is no time")
    return value


def number(value: object) -> float:
    """Return a number of single precision."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= LARGEST_SINGLE:
        raise MalformedWireError(f"{value!r:.80} is no number")
    return float(value)


def amount(value: object, most: float) -> float:
    """Return a value from 0 to `most` that travelled in 16 bits, or in single precision."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value < math.inf:
        raise MalformedWireError(f"{value!r:.80} is no amount")
    if isinstance(value, int) and value >= CODES:
        raise MalformedWireError(f"{value} is more than 16 bits")
    found = decoded(value)
    if found > most:
        raise MalformedWireError(f"{found} is more than {most}")
    return found
