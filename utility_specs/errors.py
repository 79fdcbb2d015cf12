"""What can be wrong with what an operator wrote; every problem says where it is and what to do."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class SpecProblem:
    """One mistake in one file. `line` counts from 1, None is the whole file; `key` may be empty."""

    file: Path
    line: int | None
    key: str
    message: str

    def __str__(self) -> str:
        place = str(self.file) if self.line is None else f"{self.file}:{self.line}"
        return ": ".join(part for part in (place, self.key, self.message) if part)


class SpecsError(Exception):
    """Files that cannot be used; `problems` are all mistakes found in all of them, `str` has one per line."""

    def __init__(self, problems: Iterable[SpecProblem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(map(str, self.problems)))


class TomlError(SpecsError):
    """A file that cannot be read as TOML: missing, unreadable, not UTF-8, a syntax error. One problem."""


class QuantityError(ValueError):
    """A quantity without a meaning: no unit where one is needed, an unknown unit, not a number."""


class ExpressionError(ValueError):
    """An expression that cannot be compiled, or that has no finite value for the features at hand."""


class FeatureError(ValueError):
    """A payload that a feature cannot be computed from."""
