"""Quantities as people write them: `"2 Mbit/s"`, `"200 ms"`. Inside, everything is bytes, seconds and joules.

Prefixes are decimal (1 kbit = 1000 bit), as everywhere in networking; `KiB` and its kin are powers of 1024.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from utility_specs.errors import QuantityError
from utility_specs.suggestions import described, listed, quoted

_WRITTEN = re.compile(r"\s*+([+-]?\d++(?:_\d++)*+(?:\.\d++)?+(?:[eE][+-]?\d++)?+)\s*+([^\s_.,].*?)?\s*")

_PREFIXES = {"": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}
_BINARY = {"Ki": 1024.0, "Mi": 1024.0**2, "Gi": 1024.0**3}

LEAST, MOST = 1e-12, 1e15
"""What is less or more, in base units, nobody means, and sums of squares of it are soon no finite numbers any more."""
SHORTEST = 1e-9
"""The shortest duration [s]: of shorter ones a stream of years would have more than 64 bits can count."""

MOST_LISTED = 16
"""Units that a message lists."""

_OTHER_WORDS = {
    **{f"{prefix.lower()}{bits}": f"{prefix}bit/s" for prefix in _PREFIXES for bits in ("bps", "b/s")},
    **dict.fromkeys(("sec", "secs", "second", "seconds"), "s"),
    **dict.fromkeys(("msec", "millis", "milliseconds"), "ms"),
    **dict.fromkeys(("m", "minute", "minutes"), "min"),
    **dict.fromkeys(("percent", "pct"), "%"),
    **dict.fromkeys(("joule", "joules", "ws"), "J"),
    **dict.fromkeys(("byte", "bytes"), "B"),
    **dict.fromkeys(("kilobyte", "kilobytes"), "kB"),
    **dict.fromkeys(("megabyte", "megabytes"), "MB"),
    **dict.fromkeys(("hertz", "/s", "per second"), "Hz"),
}
"""What people also call units, in lower case."""


@dataclass(frozen=True, slots=True)
class Dimension:
    """A kind of quantity: factors of its units to the base unit, and what a number may be.

    `plain`: a number alone will do; `zero`: 0 will, too; `negative`: any will; `least`, `most`: else the bounds.
    """

    name: str
    units: Mapping[str, float]
    example: str
    plain: bool
    zero: bool = False
    negative: bool = False
    least: float = LEAST
    most: float = MOST

    def parse(self, written: Any) -> float:
        """Return a quantity in the base unit; raises QuantityError, which says what to write."""
        if isinstance(written, bool) or not isinstance(written, str | int | float):
            raise QuantityError(f"must be a {self.name} such as {quoted(self.example)}, not {described(written)}")
        quantity = self._of_text(written) if isinstance(written, str) else self._of_number(written)
        if not (math.isfinite(quantity) and (self.negative or quantity > 0.0 or (self.zero and quantity == 0.0))):
            least = "" if self.negative else " of at least 0" if self.zero else " above 0"
            raise QuantityError(f"must be a finite {self.name}{least}, not {described(written)}")
        if not self.negative and quantity > self.most:
            raise QuantityError(f"must be a {self.name} of at most {self._base(self.most)}, not {described(written)}")
        if not self.negative and 0.0 < quantity < self.least:
            raise QuantityError(f"must be a {self.name} of at least {self._base(self.least)}, not {described(written)}")
        return quantity

    def _base(self, number: float) -> str:
        """Write a number with the base unit, if that has a name."""
        return " ".join([f"{number:g}", *(unit for unit, factor in self.units.items() if factor == 1.0)][:2])

    def _of_text(self, text: str) -> float:
        found = _WRITTEN.fullmatch(text)
        if found is None:
            raise QuantityError(f"{described(text)} is not a {self.name}; write for example {quoted(self.example)}")
        if found[2] is None:
            return self._of_number(float(found[1]))
        unit = found[2] if found[2].isascii() else _normal(found[2])
        if unit not in self.units:
            raise QuantityError(f"unknown unit {quoted(unit)} ({self._hint(unit)})")
        return float(found[1]) * self.units[unit]

    def _hint(self, unit: str) -> str:
        """Return what to write for an unknown unit; a guess by likeness could be wrong by a factor of 8."""
        same = {known.lower(): known for known in self.units} | _OTHER_WORDS
        meant = same.get(unit.lower(), "")
        if meant in self.units:
            return f"did you mean {quoted(meant)}?"
        few = len(self.units) <= MOST_LISTED
        return f"known units: {listed(self.units)}" if few else f"write for example {quoted(self.example)}"

    def _of_number(self, number: float) -> float:
        if not self.plain:
            raise QuantityError(f"needs a unit; write for example {quoted(self.example)}")
        try:
            return float(number)
        except OverflowError:
            return math.inf


def _bits_and_bytes(per: str) -> dict[str, float]:
    bits = {f"{prefix}bit{per}": factor / 8.0 for prefix, factor in _PREFIXES.items()}
    return bits | {f"{prefix}B{per}": factor for prefix, factor in (_PREFIXES | _BINARY).items()}


RATE = Dimension("rate", _bits_and_bytes("/s"), "2 Mbit/s", plain=False)
SIZE = Dimension("size", _bits_and_bytes(""), "50 kB", plain=False)
DURATION = Dimension(
    "duration",
    {"s": 1.0, "ms": 1e-3, "us": 1e-6, "μs": 1e-6, "min": 60.0, "h": 3600.0},
    "200 ms",
    plain=True,
    least=SHORTEST,
)
FREQUENCY = Dimension(
    "frequency", {"Hz": 1.0, "kHz": 1e3, "mHz": 1e-3, "1/s": 1.0, "1/min": 1 / 60}, "0.2 Hz", plain=False
)
AGE = replace(DURATION, zero=True)
FRACTION = Dimension("fraction", {"%": 0.01}, "40 %", plain=True, most=1.0)
JOULE = Dimension(
    "quantity of energy",
    {"J": 1.0, "mJ": 1e-3, "uJ": 1e-6, "μJ": 1e-6, "nJ": 1e-9, "kJ": 1e3, "mWh": 3.6, "Wh": 3600.0},
    "0.5 J",
    plain=False,
)
PART = replace(FRACTION, zero=True)
QUANTITY = Dimension(
    "number or quantity",
    {**DURATION.units, **SIZE.units, **RATE.units, **FREQUENCY.units, **FRACTION.units, **JOULE.units},
    "500 kB",
    plain=True,
    negative=True,
)

Rate = Annotated[float, BeforeValidator(RATE.parse, json_schema_input_type=str), Field(examples=["2 Mbit/s"])]
"""[B/s], written with a unit: bits and bytes are mixed up too easily."""

Size = Annotated[float, BeforeValidator(SIZE.parse, json_schema_input_type=str), Field(examples=["50 kB"])]
"""[B], written with a unit."""

Duration = Annotated[
    float, BeforeValidator(DURATION.parse, json_schema_input_type=float | str), Field(examples=["200 ms"])
]
"""[s], written with a unit or as a number of seconds."""

Frequency = Annotated[float, BeforeValidator(FREQUENCY.parse, json_schema_input_type=str), Field(examples=["0.2 Hz"])]
"""[1/s], written with a unit."""

Fraction = Annotated[
    float, BeforeValidator(FRACTION.parse, json_schema_input_type=float | str), Field(examples=["40 %"])
]
"""A part of a whole, above 0 and at most 1, written in percent or as a number."""

Joule = Annotated[float, BeforeValidator(JOULE.parse, json_schema_input_type=str), Field(examples=["0.5 J"])]
"""[J], written with a unit: batteries are rated in watt hours, radios in millionths of a joule."""


Age = Annotated[float, BeforeValidator(AGE.parse, json_schema_input_type=float | str), Field(examples=["200 ms"])]
"""[s], a duration that may be 0."""

Part = Annotated[float, BeforeValidator(PART.parse, json_schema_input_type=float | str), Field(examples=["10 %"])]
"""A fraction that may be 0."""

Quantity = Annotated[
    float, BeforeValidator(QUANTITY.parse, json_schema_input_type=float | str), Field(examples=["500 kB"])
]
"""Any number, or any quantity in its base unit: s, B, B/s, Hz, J, part of a whole."""


def _normal(unit: str) -> str:
    """Return a unit as Unicode would rather have it written: there are two µ."""
    import unicodedata

    return unicodedata.normalize("NFKC", unit)
