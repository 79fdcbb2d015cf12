"""What an operator writes for the worth of a sample by its age: a table for each kind of message utility."""

from abc import abstractmethod
from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, field_validator

from planner.utility import Custom, Exponential, Linear, MessageUtility, Polynomial, Power, Step, Table, Video
from utility_specs.imports import imported
from utility_specs.units import MOST, Age, Duration

MOST_POINTS = 1000
"""Points of a table."""

Worth = Annotated[float, Field(gt=0.0, le=MOST)]
Point = Annotated[tuple[Age, Annotated[float, Field(ge=0.0, le=MOST)]], Field(strict=False)]
"""Age [s] and value [1/s], written as an array of two."""


class UtilityTable(BaseModel):
    """A message utility; each kind adds its `kind` and parameters."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)

    @abstractmethod
    def utility(self, features: Mapping[str, float]) -> MessageUtility:
        """Return the planner's function, for these features of a sample; raises ProblemError when it fails."""


class LinearTable(UtilityTable):
    """`max(0, u0 − slope·age)`."""

    kind: Literal["linear"]
    u0: Worth = Field(default=1.0, description="the value of a new sample")
    slope: Worth = Field(description="what the value loses in a second")

    def utility(self, features: Mapping[str, float]) -> MessageUtility:  # noqa: ARG002 - age alone matters
        """Return the planner's function."""
        return Linear(self.u0, self.slope)


class ExponentialTable(UtilityTable):
    """`u0·exp(−age / tau)`."""

    kind: Literal["exponential"]
    u0: Worth = Field(default=1.0, description="the value of a new sample")
    tau: Duration = Field(description="the age at which 37 % of the value is left")

    def utility(self, features: Mapping[str, float]) -> MessageUtility:  # noqa: ARG002 - age alone matters
        """Return the planner's function."""
        return Exponential(self.u0, self.tau)


class StepTable(UtilityTable):
    """`u0` while the age is less than `lifetime`, then 0."""

    kind: Literal["step"]
    u0: Worth = Field(default=1.0, description="the value of a new sample")
    lifetime: Duration = Field(description="the age from which on a sample is worth nothing")

    def utility(self, features: Mapping[str, float]) -> MessageUtility:  # noqa: ARG002 - age alone matters
        """Return the planner's function."""
        return Step(self.u0, self.lifetime)


class PolynomialTable(UtilityTable):
    """`max(0, u0·(1 − (age / a1)^k))`."""

    kind: Literal["polynomial"]
    u0: Worth = Field(default=1.0, description="the value of a new sample")
    a1: Duration = Field(description="the age from which on a sample is worth nothing")
    k: float = Field(
        default=2.0, gt=0.0, description="how late the value falls: 2 for positions in the plane, 3 in space"
    )

    def utility(self, features: Mapping[str, float]) -> MessageUtility:  # noqa: ARG002 - age alone matters
        """Return the planner's function."""
        return Polynomial(self.u0, self.a1, self.k)


class VideoTable(UtilityTable):
    """1 up to the age `a0`, then falling with its logarithm to 0 at `a1`."""

    kind: Literal["video"]
    a0: Duration = Field(default=1 / 30, description="the age up to which the value is 1")
    a1: Duration = Field(
        default=10.0, validate_default=True, description="the age from which on a sample is worth nothing"
    )

    @field_validator("a1")
    @classmethod
    def _after_a0(cls, a1: float, info: ValidationInfo) -> float:
        a0 = info.data.get("a0", 0.0)
        if a1 <= a0:
            raise ValueError(f"must be more than a0 ({a0:g} s), not {a1:g} s")
        return a1

    def utility(self, features: Mapping[str, float]) -> MessageUtility:  # noqa: ARG002 - age alone matters
        """Return the planner's function."""
        return Video(self.a0, self.a1)


class PowerTable(UtilityTable):
    """`(1 − beta)·age^(−beta)`, age in seconds."""

    kind: Literal["power"]
    beta: float = Field(gt=0.0, lt=1.0, description="how quickly the value falls, between 0 and 1")

    def utility(self, features: Mapping[str, float]) -> MessageUtility:  # noqa: ARG002 - age alone matters
        """Return the planner's function."""
        return Power(self.beta)


class PointsTable(UtilityTable):
    """Straight lines through points of age and value; before the first and after the last, the value there."""

    kind: Literal["table"]
    points: Annotated[list[Point], Field(min_length=1, max_length=MOST_POINTS)] = Field(
        description="pairs of age and value with rising ages; the last value holds for ever"
    )

    @field_validator("points")
    @classmethod
    def _rising(cls, points: list[Point]) -> list[Point]:
        for (before, _), (after, _) in pairwise(points):
            if after <= before:
                raise ValueError(f"must have rising ages, not {after:g} s after {before:g} s")
        return points

    def utility(self, features: Mapping[str, float]) -> MessageUtility:  # noqa: ARG002 - age alone matters
        """Return the planner's function; raises ProblemError when points are too close or too large."""
        return Table(tuple(self.points))


class PythonTable(UtilityTable):
    """What a Python function returns for ages and features; from the age `until` on, what it returns there."""

    kind: Literal["python"]
    function: str = Field(description="package.module:name; it gets ages and features and returns values")
    until: Duration = Field(default=60.0, description="the age from which on the last value holds")

    @field_validator("function")
    @classmethod
    def _importable(cls, path: str) -> str:
        imported(path)
        return path

    def utility(self, features: Mapping[str, float]) -> MessageUtility:
        """Return the planner's function, tabulated; raises ProblemError when the Python function fails."""
        return Custom(imported(self.function), features, self.until)


AnyUtilityTable = Annotated[
    LinearTable | ExponentialTable | StepTable | PolynomialTable | VideoTable | PowerTable | PointsTable | PythonTable,
    Field(discriminator="kind"),
]
"""The table of any kind of message utility, told apart by its `kind`."""
