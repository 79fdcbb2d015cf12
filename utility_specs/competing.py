"""What samples of different kinds are worth for what they take: value in their first second by byte."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from planner.utility import integral
from utility_specs.errors import ExpressionError
from utility_specs.explaining import Explanation
from utility_specs.loader import SpecSet
from utility_specs.specs import InformationType


@dataclass(frozen=True, slots=True)
class Competitor:
    """What a sample is worth in its first second [utility·s], and its size [B]; None: not known."""

    name: str
    value: float | None
    size: float | None
    this: bool = False
    note: str = ""

    @property
    def per_kilobyte(self) -> float | None:
        """What each 1000 bytes of it are worth [utility·s]; None where that is not known."""
        return self.value * 1000.0 / self.size if self.value is not None and self.size else None

    def data(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        return asdict(self) | {"per_kilobyte": self.per_kilobyte}


def competitors(specs: SpecSet, explanation: Explanation, sizes: Mapping[str, float]) -> tuple[Competitor, ...]:
    """Return the sample among typical ones of all other types, the worthiest by byte first.

    `sizes` are those of types by name [B], as far as they are known.
    """
    worth = explanation.worth
    others = [
        _typical(of, sizes.get(of.name)) for of in specs.specs.types if worth is None or of.name != worth.type.name
    ]
    if worth is None:
        return ranked(others)
    this = Competitor(worth.type.name, worth.value, explanation.size, this=True, note=rules(worth.type))
    return ranked([this, *others])


def typical_sizes(specs: SpecSet) -> dict[str, float]:
    """Return how large samples of types are by name [B], as far as specs say (`forecast.size`)."""
    tables = [table for file in specs.files for table in file.tables.information_type]
    return {table.name: table.forecast.size for table in tables if table.forecast.size is not None}


def ranked(competitors: Sequence[Competitor]) -> tuple[Competitor, ...]:
    """Return them by value for bytes, those of which that is not known last."""
    return tuple(sorted(competitors, key=_worthiness, reverse=True))


def rules(of: InformationType) -> str:
    """Say why samples of a type do not compete like others; nothing where they do."""
    if of.bypass:
        return "bypasses the planner"
    return "always passes" if of.mode == "pass" else ""


def _worthiness(each: Competitor) -> float:
    return -1.0 if each.per_kilobyte is None else each.per_kilobyte


def _typical(of: InformationType, size: float | None) -> Competitor:
    notes = [rules(of)] if rules(of) else []
    value = None
    try:
        value = _scale(of) * integral(of.utility, 1.0)
    except ExpressionError:
        notes.append("worth depends on the key")
    if size is None:
        notes.append("size not known")
    return Competitor(of.name, value, size, note=", ".join(notes))


def _scale(of: InformationType) -> float:
    """Return weight × scale for the defaults of all features; raises ExpressionError where it depends on the key."""
    values = of.completed({})
    return max(0.0, of.weighing.evaluate(values)) * max(0.0, of.expression.evaluate(values))
