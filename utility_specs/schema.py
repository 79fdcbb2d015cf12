"""The format of a spec file: what an operator may write, and what of it can be judged table by table."""

import keyword
import re
from typing import Annotated, Literal

import zenoh
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationInfo, field_validator

from planner.problem import Aggregation, AggregationModel
from planner.utility import MessageUtility
from utility_specs.aggregations import AnyAggregation, aggregation_of
from utility_specs.constraint_tables import AnyConstraintTable
from utility_specs.expressions import CONSTANTS, FUNCTIONS, Expression
from utility_specs.features import AnyFeatureTable
from utility_specs.forecast import AnyFeatureForecast
from utility_specs.names import Name
from utility_specs.schedules import AnySchedule
from utility_specs.suggestions import described
from utility_specs.utilities import AnyUtilityTable


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


class ForecastTable(Table):
    """How what is not known yet is estimated: the features of a stream's next samples, and when it generates them."""

    features: AnyFeatureForecast = "last"
    schedule: AnySchedule = "auto"


class InformationTypeTable(Table):
    """What is said about a group of keys. `features` stands before `scale`, which may use them."""

    name: Name
    keys: Annotated[list[KeyExpression], Field(min_length=1)]
    aggregation: AnyAggregation = "most_recent"
    weight: float = Field(default=1.0, ge=0.0)
    utility: AnyUtilityTable
    features: dict[FeatureName, AnyFeatureTable] = {}
    scale: str = "1"
    forecast: ForecastTable = ForecastTable()

    @field_validator("scale")
    @classmethod
    def _compiles(cls, scale: str, info: ValidationInfo) -> str:
        if "features" in info.data:  # else they have problems of their own
            Expression.compile(scale, info.data["features"])
        return scale

    def message_utility(self) -> MessageUtility:
        """Return the planner's function, for the defaults of all features; raises ProblemError when it fails."""
        return self.utility.utility({name: feature.default for name, feature in self.features.items()})

    def aggregated(self) -> Aggregation | AggregationModel:
        """Return what the planner combines samples by; raises ProblemError when a class of the operator's fails."""
        return aggregation_of(self.aggregation, self.message_utility())


class SpecFile(Table):
    """One file. The tables are named in the singular, as TOML repeats them one by one."""

    version: Literal[1] = 1
    constraint: list[AnyConstraintTable] = []
    information_type: list[InformationTypeTable] = []
