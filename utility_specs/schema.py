"""The format of a spec file: what an operator may write, and what of it can be judged table by table."""

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self, get_args

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainValidator,
    ValidationInfo,
    field_validator,
)

from planner.problem import Aggregation, AggregationModel
from planner.utility import MessageUtility
from utility_specs.aggregations import AnyAggregation, aggregation_of
from utility_specs.constraint_tables import AnyConstraintTable
from utility_specs.effort import Sparingly, at_most, read
from utility_specs.errors import ExpressionError
from utility_specs.expressions import Expression, Names
from utility_specs.features import AnyFeatureTable
from utility_specs.forecast import AnyFeatureForecast
from utility_specs.key_formats import KeyFormat
from utility_specs.names import ConstantName, FeatureName, Name, variable
from utility_specs.rules import Deletes, Fallback, Queries, TypeMode
from utility_specs.schedules import AnySchedule
from utility_specs.suggestions import described, quoted
from utility_specs.units import Duration, Fraction, Frequency, Part, Quantity, Size
from utility_specs.utilities import AnyUtilityTable, PythonTable

MOST_TYPES = 128
"""Information types of one file at most."""
MOST_CONSTRAINTS = 32
"""Constraints of one file at most: every decision reckons with each of them."""
MOST_CONSTANTS = 64
"""Constants of one file at most."""
MOST_OF_A_TYPE = 64
"""Keys of an information type, and its features at most."""
MOST_TOLD = 32
"""Features of a type with a `python` utility at most: robots tell each other all of them, and no more."""
MOST_KEYS = 256
"""Keys of all types of one file at most: each is compared with all before it."""

Urgency = Literal["real_time", "interactive_high", "interactive_low", "data_high", "data", "data_low", "background"]
"""Zenoh's priorities, from 1 on."""


class Table(BaseModel):
    """A table that knows all its keys and converts nothing silently."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


def _format(text: str) -> str:
    for name, _ in KeyFormat.parse(text).captures:
        variable(name, "captured chunk")
    return text


def _version(written: Any) -> Any:
    if type(written) is not int:
        raise ValueError(f"must be the whole number 1, not {described(written)}")
    return written


def _weight(written: Any) -> str | float:
    if isinstance(written, str):
        return written
    if isinstance(written, bool) or not isinstance(written, int | float):
        raise ValueError(f"must be a number or an expression, not {described(written)}")  # noqa: TRY004 - for pydantic
    try:
        weight = float(written)
    except OverflowError:
        weight = math.inf
    if not math.isfinite(weight):
        raise ValueError(f"must be a finite number, not {described(written)}")
    if weight < 0.0:
        raise ValueError(f"must be at least 0, not {described(written)}")
    return weight


KeyText = Annotated[str, AfterValidator(_format)]
Weight = Annotated[str | float, PlainValidator(_weight, json_schema_input_type=float | str)]


class ForecastTable(Table):
    """How what is not known yet is estimated: the features of a stream's next samples, and when it generates them."""

    features: AnyFeatureForecast = Field(
        default="last", description="what the next samples will show: last, mean, trend, auto, or methods by feature"
    )
    schedule: AnySchedule = Field(default="auto", description="when streams generate: auto finds it out")
    size: Size | None = Field(default=None, description="how large a sample is, for `sendworthy check` to reckon with")
    streams: int = Field(
        default=1,
        ge=1,
        le=1_000_000,
        description="how many streams there are, all robots together, for `sendworthy check` to reckon with",
    )


class FallbackTable(Table):
    """What decides when the planner fails: priority, and a token bucket for each limit."""

    urgent: Urgency = Field(
        default="data_high", description="samples of this priority and above may take all that the limits leave"
    )
    part: Fraction = Field(
        default=0.5, description="what samples of lower priority may take of it; that part fills their token buckets"
    )

    def fallback(self) -> Fallback:
        """Return the rule."""
        return Fallback(1 + get_args(Urgency).index(self.urgent), self.part)


class InformationTypeTable(Table):
    """What is said about a group of keys. What `scale` and `weight` may use stands before them."""

    name: Name = Field(description="what messages and the status call it")
    keys: Annotated[list[Annotated[KeyText, Sparingly]], Field(min_length=1, max_length=MOST_OF_A_TYPE)] = Field(
        description="key expressions; ${name:*} captures a chunk for expressions", examples=[["robot/${robot:*}/pose"]]
    )
    mode: TypeMode | None = Field(
        default=None, description="pass, shadow or enforce for this type, whatever the daemon's is unless that is pass"
    )
    bypass: bool = Field(default=False, description="samples go at once and may exceed the limits; they are counted")
    min_rate: Frequency | None = Field(default=None, description="samples of each stream to be sent at least")
    max_age: Duration | None = Field(default=None, description="the oldest that a receiver's last sample shall become")
    deletes: Deletes = Field(default="bypass", description="bypass: deletes always pass; decide: the planner decides")
    queries: Queries = Field(default="pass", description="pass: queries cross; drop: those for these keys do not")
    aggregation: AnyAggregation = Field(
        default="most_recent",
        description="how samples of a key combine: most_recent, best, sum, once, current, or a class",
    )
    utility: AnyUtilityTable = Field(description="the worth of a sample by its age")
    features: Annotated[
        dict[FeatureName, Annotated[AnyFeatureTable, Sparingly]],
        Field(max_length=MOST_OF_A_TYPE),
        at_most(MOST_OF_A_TYPE),
    ] = Field(default={}, description="numbers computed from samples, by the names that expressions use")
    weight: Weight = Field(default=1.0, description="worth against other types: a number, or an expression like scale")
    scale: str = Field(default="1", description="an expression that multiplies the utility", examples=["1 + 10 * red"])
    forecast: ForecastTable = Field(default=ForecastTable(), description="what is expected of the samples to come")

    @property
    def formats(self) -> tuple[KeyFormat, ...]:
        """The keys, taken apart."""
        return tuple(map(KeyFormat.parse, self.keys))

    @field_validator("features")
    @classmethod
    def _distinct(cls, features: dict[str, Any], info: ValidationInfo) -> dict[str, Any]:
        captures = _captures(info.data.get("keys", []))
        for name in features:
            if name in captures:
                raise ValueError(f"{quoted(name)} is captured by keys; choose another name for the feature")
            if name in (_constants(info) or ()):
                raise ValueError(f"{quoted(name)} is a constant; choose another name for the feature")
        if len(features) > MOST_TOLD and isinstance(info.data.get("utility"), PythonTable):
            raise ValueError(f"a python utility has at most {MOST_TOLD} features, not {len(features)}")
        return features

    @field_validator("weight")
    @classmethod
    def _weighs(cls, weight: str | float, info: ValidationInfo) -> str | float:
        return _compiled(weight, info) if isinstance(weight, str) else weight

    @field_validator("scale")
    @classmethod
    def _scales(cls, scale: str, info: ValidationInfo) -> str:
        return _compiled(scale, info)

    def expressions(self, constants: Mapping[str, float]) -> tuple[Expression, Expression]:
        """Return weight and scale, compiled."""
        names = _names(self.features, self.keys, constants)
        return Expression.compile(str(self.weight), names), Expression.compile(self.scale, names)

    def message_utility(self) -> MessageUtility:
        """Return the planner's function, for the defaults of all features; raises ProblemError when it fails."""
        return self.utility.utility(_defaults(self.features) | dict.fromkeys(_captures(self.keys), 1.0))

    def aggregated(self) -> Aggregation | AggregationModel:
        """Return what the planner combines samples by; raises ProblemError when a class of the operator's fails."""
        return aggregation_of(self.aggregation, self.message_utility())


class SpecFile(Table):
    """One file. The tables are named in the singular, as TOML repeats them one by one."""

    version: Annotated[Literal[1], BeforeValidator(_version)] = Field(
        default=1, description="the version of this format"
    )
    floor: Part | None = Field(
        default=None,
        description="the part of every limit that traffic without a spec leaves to types, at least; 10 % unless set",
    )
    fallback: FallbackTable | None = Field(default=None, description="what decides when the planner fails")
    constants: Annotated[
        dict[ConstantName, Annotated[Quantity, Sparingly]], Field(max_length=MOST_CONSTANTS), at_most(MOST_CONSTANTS)
    ] = Field(
        default={},
        validate_default=True,
        description="numbers by name, for expressions; quantities count in s, B, B/s, Hz, J",
    )
    constraint: Annotated[
        list[Annotated[AnyConstraintTable, Sparingly]], Field(max_length=MOST_CONSTRAINTS), at_most(MOST_CONSTRAINTS)
    ] = Field(default=[], description="what may be sent at most")
    information_type: Annotated[
        list[Annotated[InformationTypeTable, Sparingly]], Field(max_length=MOST_TYPES), at_most(MOST_TYPES)
    ] = Field(default=[], description="what samples of a group of keys are worth")

    @classmethod
    def of(cls, data: dict[str, Any], **context: Any) -> Self:
        """Return the file with this data; raises ValidationError. Only so do expressions know the constants."""
        return cls.model_validate(data, context=context)

    @field_validator("constants")
    @classmethod
    def _known_below(cls, constants: dict[str, float], info: ValidationInfo) -> dict[str, float]:
        if info.context is not None:
            info.context["constants"] = constants
        return constants

    @field_validator("information_type")
    @classmethod
    def _comparable(cls, types: list[InformationTypeTable]) -> list[InformationTypeTable]:
        keys = sum(len(each.keys) for each in types)
        if keys > MOST_KEYS:
            raise ValueError(f"must have at most {MOST_KEYS} keys in all, not {keys}")
        return types


def _constants(info: ValidationInfo) -> Mapping[str, float] | None:
    """Return the constants of the file; None when they are wrong."""
    return {} if info.context is None else info.context.get("constants")


def _compiled(text: str, info: ValidationInfo) -> str:
    """Return an expression that can be compiled and has a value; raises ValueError."""
    read(text, info)
    constants, features, keys = _constants(info), info.data.get("features"), info.data.get("keys")
    if constants is not None and features is not None and keys is not None:  # else they have problems of their own
        _try(Expression.compile(text, _names(features, keys, constants)), features, keys)
    return text


def _captures(keys: list[str]) -> dict[str, None]:
    return {name: None for key in keys for name, _ in KeyFormat.parse(key).captures}


def _defaults(features: dict[str, Any]) -> dict[str, float]:
    return {name: feature.default for name, feature in features.items()}


def _names(features: dict[str, Any], keys: list[str], constants: Mapping[str, float]) -> Names:
    return Names(frozenset(features), frozenset(_captures(keys)), constants)


def _try(expression: Expression, features: dict[str, Any], keys: list[str]) -> None:
    """Raise ExpressionError where an expression has no value for the default features, or for some keys."""
    captured = expression.names & _captures(keys).keys()
    for number, key in enumerate(keys):
        lacking = captured - _captures([key]).keys()
        if lacking:
            raise ExpressionError(f"uses {quoted(min(lacking))}, which keys[{number}] does not capture")
    if captured:
        return  # no key is known yet
    used = {name: value for name, value in _defaults(features).items() if name in expression.names}
    try:
        expression.evaluate(used)
    except ExpressionError as error:
        what, _, cause = str(error).partition(": ")
        where = ", ".join(f"{name} = {value:g}" for name, value in sorted(used.items()))
        raise ExpressionError(f"{what} for the default {where}: {cause}") from None
