"""What an operator writes for how the samples of one key combine: a name, or a class of one's own."""

from functools import cached_property
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, field_validator

from planner import Message, Problem, SearchSettings, Stream, start
from planner.errors import ProblemError
from planner.problem import Aggregation, AggregationModel
from planner.utility import MessageUtility, Power
from utility_specs.imports import imported

METHODS = ("empty", "add", "value")


class PythonAggregation(BaseModel):
    """An aggregation that the class `python` defines, written `package.module:Class`."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    python: str = Field(description="package.module:Class with the methods empty, add and value")

    @field_validator("python")
    @classmethod
    def _importable(cls, path: str) -> str:
        imported(path, "class")
        return path

    @cached_property
    def model(self) -> AggregationModel:
        """The one instance of the class; raises ProblemError when that fails or has not all methods."""
        try:
            made = imported(self.python, "class")()
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            raise ProblemError(f"{self.python}() failed: {type(error).__name__}: {error}") from error
        lacking = [f"{name}()" for name in METHODS if not callable(getattr(made, name, None))]
        if lacking:
            raise ProblemError(f"{self.python} has no {' and no '.join(lacking)}; an aggregation has empty, add, value")
        model: AggregationModel = made
        return model


def _form(value: Any) -> str:
    return "table" if isinstance(value, dict | PythonAggregation) else "name"


AnyAggregation = Annotated[
    Annotated[Literal["most_recent", "best", "sum", "once", "current"], Tag("name")]
    | Annotated[PythonAggregation, Tag("table")],
    Discriminator(_form),
]
"""One of the planner's own by name, or a table for one of the operator's."""


def aggregation_of(said: str | PythonAggregation, utility: MessageUtility) -> Aggregation | AggregationModel:
    """Return what the planner combines samples by; raises ProblemError when a class fails.

    A class is tried with nothing received, and with samples of this `utility`. `current` needs one with a first value.
    """
    if isinstance(said, str):
        if said == Aggregation.CURRENT and isinstance(utility, Power):
            raise ProblemError(
                '"current" needs a utility that is finite at the age 0, to know what is lost; "power" is not'
            )
        return Aggregation(said)
    _try(said.model, utility)
    return said.model


def _try(model: AggregationModel, utility: MessageUtility) -> None:
    """Let the planner work with the model as it will in flight; raises ProblemError."""
    messages = tuple(Message(0, t, t, t + 0.1, utility, 1.0, ()) for t in (0.0, 1.0))
    problem = Problem((Stream(0, model),), messages, 0, (), (), 0.0, 2.0)
    try:
        start(problem, SearchSettings())
    except ProblemError as error:
        raise ProblemError(str(error).removeprefix("stream 0: aggregation ")) from error
