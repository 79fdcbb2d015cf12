"""How a value in a document becomes a number: it is one, it is compared, or many are reduced to one."""

from dataclasses import dataclass
from math import isfinite
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from utility_specs.errors import FeatureError
from utility_specs.features.feature import FeatureTable
from utility_specs.features.path import Path, Step, follow, many, steps_of
from utility_specs.suggestions import LONGEST_NUMBER, described

Reduction = Literal["length", "min", "max", "mean", "sum"]


def _plain(value: Any) -> Any:
    if not isinstance(value, bool | int | float | str):
        raise ValueError(f"must be a string, a number, true or false, not {described(value)}")  # noqa: TRY004 - for pydantic
    if isinstance(value, float) and not isfinite(value):
        raise ValueError(f"must be finite, not {described(value)}")
    if isinstance(value, int) and value.bit_length() > LONGEST_NUMBER:
        raise ValueError(f"must have {LONGEST_NUMBER} bits at most, not be {described(value)}")
    return value


Plain = Annotated[bool | int | float | str, BeforeValidator(_plain)]
"""What a value may be compared with."""


@dataclass(frozen=True, slots=True)
class Reading:
    """A place in a document, and how what is there becomes a number."""

    steps: tuple[Step, ...] = ()
    equals: bool | float | str | None = None
    reduce: Reduction | None = None

    def of(self, document: Any) -> float:
        """Return the number; any exception means that there is none."""
        value = follow(document, self.steps)
        if self.reduce is None:
            return self._number(value)
        if self.reduce == "length":
            return float(len(value))
        import numpy as np

        numbers = self._numbers(value)
        finite = numbers[np.isfinite(numbers)]  # lidars say inf where they see nothing
        if not finite.size and self.equals is not None and self.reduce in {"sum", "max"}:
            return 0.0  # nothing equals it
        if not finite.size:
            raise FeatureError("there are no numbers to reduce")
        return float(getattr(np, self.reduce)(finite))

    def _numbers(self, values: Any) -> Any:
        import numpy as np

        if hasattr(values, "dtype") and self.equals is None:
            return values.astype(float)
        if not isinstance(values, list | tuple) and not hasattr(values, "dtype"):
            raise FeatureError(f"a {type(values).__name__} is not an array")
        return np.array([self._number(each) for each in values])

    def _number(self, value: Any) -> float:
        if hasattr(value, "dtype"):
            value = value.item()  # NumPy's numbers; of an array with more than one a ValueError
        if self.equals is not None:
            return float(value == self.equals)
        if isinstance(value, bool | int | float):
            return float(value)
        raise FeatureError(f"a {type(value).__name__} is not a number")


class ReadingTable(FeatureTable):
    """What is said of a value in a document."""

    equals: Plain | None = Field(
        default=None, description="What the value is compared with: 1 if they are equal, else 0."
    )
    reduce: Reduction | None = Field(default=None, description="What is made of an array: one number.")

    @model_validator(mode="after")
    def _one_number(self) -> Self:
        if self.reduce == "length" and self.equals is not None:
            raise ValueError('reduce = "length" counts all values; to count those that equal one, write "sum"')
        return self


def reading(path: str, table: ReadingTable) -> Reading:
    """Return how a table reads the value at a path."""
    return Reading(steps_of(path), table.equals, table.reduce)


def needs_reduce(path: str, table: ReadingTable) -> None:
    """Raise ValueError where a path leads to many values and the table does not say what is made of them."""
    if many(steps_of(path)) and table.reduce is None:
        raise ValueError('with [*] there are many values: add reduce = "max", "min", "mean", "sum" or "length"')


class PathTable(ReadingTable):
    """A value in a document that has names and indices."""

    path: Path = Field(default="", description="Where the value is, such as pose.position[0].x; all of it without.")

    @model_validator(mode="after")
    def _reduced(self) -> Self:
        needs_reduce(self.path, self)
        return self

    def reading(self) -> Reading:
        """Return how the value is read."""
        return reading(self.path, self)
