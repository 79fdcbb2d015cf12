"""Numbers as they travel: times in ticks, values in 16 bits. Whoever tells a value uses it rounded like its hearers."""

import math
import struct

_PER_SECOND = 10_000
"""Times travel as whole ticks, of which a second has so many."""
_SMALL = 128
"""Whole numbers below this travel as they are, in one byte."""
_BITS = 1024
"""Steps of a value from one power of two to the next."""
_LEAST, _MOST = -31, 32
"""Binary exponents of values that fit into 16 bits."""
_SINGLE = struct.Struct("<f")
LARGEST_SINGLE = 3.4028234663852886e38
CODES = 2**16
"""Values travel as whole numbers below this."""


def ticks(seconds: float) -> int:
    """Return a time in ticks."""
    return round(seconds * _PER_SECOND)


def seconds(ticks_: int) -> float:
    """Return a time in ticks in seconds."""
    return ticks_ / _PER_SECOND


def coded(amount: float) -> int | float:
    """Return the wire form of a value from 0: 16 bits, to 0.05 %, exact to 2,048, or beyond those single precision."""
    if amount < _SMALL and amount == int(amount):
        return int(amount)
    mantissa, exponent = math.frexp(amount)
    steps = round(mantissa * 2 * _BITS)
    if steps == 2 * _BITS:
        steps, exponent = _BITS, exponent + 1
    code = (exponent - _LEAST) * _BITS + steps - _BITS
    return code if _LEAST <= exponent <= _MOST and code >= _SMALL else single(amount)


def decoded(code: int | float) -> float:  # noqa: PYI041 - they are told apart
    """Return the value that travelled as `code`."""
    if isinstance(code, float) or code < _SMALL:
        return float(code)
    exponent, steps = divmod(code, _BITS)
    return math.ldexp(steps + _BITS, exponent + _LEAST - 11)


def rounded(amount: float) -> float:
    """Return a value as it arrives."""
    return decoded(coded(amount))


def single(number: float) -> float:
    """Return a number in single precision; beyond its range the largest there is."""
    near: float = _SINGLE.unpack(_SINGLE.pack(min(max(number, -LARGEST_SINGLE), LARGEST_SINGLE)))[0]
    return near


def feature(number: float) -> float:
    """Return a feature as it arrives: whole numbers as they are, others in single precision."""
    return number if number == math.floor(number) and abs(number) <= 2**53 else single(number)
