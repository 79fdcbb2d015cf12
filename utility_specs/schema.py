"""The format of a spec file: what an operator may write, and what of it can be judged table by table."""

import keyword
import re
from typing import Annotated, Literal

import zenoh
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationInfo, field_validator

from planner.utility import Linear, MessageUtility, Video
from utility_specs.constraint_tables import AnyConstraintTable
from utility_specs.expressions import CONSTANTS, FUNCTIONS, Expression
from utility_specs.features import AnyFeatureTable
from utility_specs.names import Name
from utility_specs.suggestions import described
from utility_specs.units import Duration


class Table(BaseModel):
    """A table that knows all its keys and converts nothing silently."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


def _feature_name(name: str) -> str:
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]{0,63}", name):
        raise ValueError("a feature's name must be letters, digits and _, and not begin with a digit")
    if name in CONSTANTS or name in FUNCTIONS or keyword.iskeyword(name):
        raise ValueError("this name has a meaning in expressions; choose another one for the feature")
    return name


def _key_expression(text: str) -> str:
    try:
        return str(zenoh.KeyExpr(text))
    except zenoh.ZError as error:
        cause = re.sub(r"^Invalid Key Expr `.*`: | at /\S*$", "", str(error).rstrip("."), flags=re.DOTALL)
        raise ValueError(f"{described(text)} is not a key expression: {cause.rstrip('.')}") from None


FeatureName = Annotated[str, AfterValidator(_feature_name)]
KeyExpression = Annotated[str, AfterValidator(_key_expression)]


class LinearTable(Table):
    """`max(0, u0 − slope·age)`."""

    kind: Literal["linear"]
    u0: float = Field(default=1.0, gt=0.0)
    slope: float = Field(gt=0.0)

    def utility(self) -> MessageUtility:
        """Return the planner's function."""
        return Linear(self.u0, self.slope)


class VideoTable(Table):
    """1 up to the age `a0`, then falling with its logarithm to 0 at `a1`."""

    kind: Literal["video"]
    a0: Duration = 1 / 30
    a1: Duration = Field(default=10.0, validate_default=True)

    @field_validator("a1")
    @classmethod
    def _after_a0(cls, a1: float, info: ValidationInfo) -> float:
        a0 = info.data.get("a0", 0.0)
        if a1 <= a0:
            raise ValueError(f"must be more than a0 ({a0:g} s), not {a1:g} s")
        return a1

    def utility(self) -> MessageUtility:
        """Return the planner's function."""
        return Video(self.a0, self.a1)


class ForecastTable(Table):
    """How what is not known yet is estimated."""

    features: Literal["last"] = "last"


class InformationTypeTable(Table):
    """What is said about a group of keys. `features` stands before `scale`, which may use them."""

    name: Name
    keys: Annotated[list[KeyExpression], Field(min_length=1)]
    aggregation: Literal["most_recent"] = "most_recent"
    weight: float = Field(default=1.0, ge=0.0)
    utility: Annotated[LinearTable | VideoTable, Field(discriminator="kind")]
    features: dict[FeatureName, AnyFeatureTable] = {}
    scale: str = "1"
    forecast: ForecastTable = ForecastTable()

    @field_validator("scale")
    @classmethod
    def _compiles(cls, scale: str, info: ValidationInfo) -> str:
        if "features" in info.data:  # else they have problems of their own
            Expression.compile(scale, info.data["features"])
        return scale


class SpecFile(Table):
    """One file. The tables are named in the singular, as TOML repeats them one by one."""

    version: Literal[1] = 1
    constraint: list[AnyConstraintTable] = []
    information_type: list[InformationTypeTable] = []
