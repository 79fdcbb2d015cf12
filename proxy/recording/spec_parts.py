"""Parts of utility specs by their places: a snapshot has these, for specs hold functions, and are in the recording."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from planner.errors import ProblemError
from planner.utility import Custom
from proxy.recording.errors import RecordingError
from utility_specs import InformationType, Specs
from utility_specs.specs import Failures

COUNTS = "counts"
"""Stands for failures that nobody looks at."""
PAST = "past"
"""Stands for a part of specs that are in force no more."""
Place = tuple[Any, ...]
"""COUNTS, PAST, the number of a part, or that of a type or utility and its features, which make another one of it."""


class Past:
    """A part of specs that are in force no more, and so in no recording: it has nothing.

    Streams that no spec covers any more have a type until they are forgotten everywhere, and `why` tells of utilities.
    No decision depends on them; should one, the replay would differ there by a fault.
    """


class SpecParts:
    """The parts of some specs, numbered as they are written."""

    def __init__(self, specs: Specs) -> None:
        self._parts: list[Any] = [specs]
        for each in specs.types:
            forecast = each.forecast
            methods = [one for some in (forecast.methods, *forecast.by_feature.values()) for one in some]
            self._parts += [each, each.failures, each.utility, each.aggregation, each.schedule, *methods]
        self._numbers = {id(part): number for number, part in reversed([*enumerate(self._parts)])}
        self._types = {id(each.failures): self._numbers[id(each)] for each in specs.types}
        self._made: dict[tuple[Any, ...], Any] = {}
        self._past = Past()
        self._counts = Failures()

    def place(self, part: Any) -> Place:
        """Return where a part of specs, or what was made of one, stands."""
        number = self._numbers.get(id(part))
        if number is not None:
            return (number,)
        if isinstance(part, InformationType) and id(part.failures) in self._types:
            return self._types[id(part.failures)], dict(part.captured)
        if isinstance(part, Failures):
            return (COUNTS,)
        if isinstance(part, Custom) and (of := self._of_function(part)) is not None:
            return of, dict(part.features)
        return (PAST,)

    def at(self, place: Place) -> Any:
        """Return the part at a place. Raises RecordingError where none is."""
        match place:
            case (str(name),) if name in (COUNTS, PAST):
                return self._counts if name == COUNTS else self._past
            case (int(number),) if 0 <= number < len(self._parts):
                return self._parts[number]
            case (int(number), dict(values)) if 0 <= number < len(self._parts):
                return self._with(number, values)
        raise RecordingError("it names a part of specs that there is not")

    def _of_function(self, utility: Custom) -> int | None:
        """Return the number of the utility with that function as its type has it."""
        alike = (
            number
            for number, part in enumerate(self._parts)
            if isinstance(part, Custom) and part.function is utility.function and part.until == utility.until
        )
        return next(alike, None)

    def _with(self, number: int, values: Mapping[str, Any]) -> Any:
        """Return a type that captures these chunks, or a utility with these features; each is made once."""
        known = (number, *values.items())
        if known not in self._made:
            part = self._parts[number]
            if isinstance(part, InformationType):
                self._made[known] = replace(part, captured=values)
            elif isinstance(part, Custom):
                self._made[known] = _with_features(part, values)
            else:
                raise RecordingError("it names a part of specs that there is not")
        return self._made[known]


def _with_features(utility: Custom, features: Mapping[str, Any]) -> Custom:
    try:
        return replace(utility, features=features)
    except ProblemError as error:
        raise RecordingError(str(error)) from None
