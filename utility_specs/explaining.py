"""Why a sample is worth what it is: its information type, features, scale, utility, and what it uses of the limits."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from math import isfinite
from pathlib import Path
from typing import Any

import zenoh

from planner.problem import Aggregation, AggregationModel
from planner.utility import Custom, MessageUtility
from utility_specs.errors import ExpressionError
from utility_specs.expressions import Expression
from utility_specs.failing_features import reason_of
from utility_specs.features import AnyPayload, Feature, Sample
from utility_specs.features.change import Change
from utility_specs.key_formats import KeyFormat
from utility_specs.lifetimes import Lifetime
from utility_specs.loader import SpecSet
from utility_specs.near_keys import Near, nearest
from utility_specs.specs import InformationType

NEAREST = 3
"""Key expressions that are told of a key that none covers."""

AGGREGATIONS: Mapping[Aggregation, str] = {
    Aggregation.MOST_RECENT: "only the newest that a robot received counts, so a newer one supersedes this one",
    Aggregation.BEST: "the best of all that a robot received counts, so this one counts where none is worth more",
    Aggregation.SUM: "all that a robot received count, added up, so none takes this one's place",
    Aggregation.ONCE: "only the first that a robot received counts, so this one is worth nothing after another one",
    Aggregation.CURRENT: "only the newest that a robot received counts, less what it shows too much once less is true",
}


@dataclass(frozen=True, slots=True)
class Covering:
    """A key expression, as it is written, that covers the key."""

    type: str
    expression: str
    file: Path
    line: int | None

    @property
    def place(self) -> str:
        """File and line."""
        return str(self.file) if self.line is None else f"{self.file}:{self.line}"

    def data(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        return asdict(self) | {"file": str(self.file)}


@dataclass(frozen=True, slots=True)
class FeatureValue:
    """What a feature is for the sample; `why` says for what reason it is the default, where it is."""

    name: str
    value: float
    why: str | None = None
    used: bool = True
    """Whether the worth depends on it."""


@dataclass(frozen=True, slots=True)
class Worked:
    """An expression, with values in place of names, and what that gives; `why` says why it counts as 1 instead."""

    text: str
    filled: str
    value: float
    why: str | None = None


@dataclass(frozen=True, slots=True)
class Use:
    """What the sample takes of a constraint: `used` of the `limit` [`unit`] in any `window` [s]."""

    name: str
    unit: str
    window: float
    limit: float
    used: float
    adaptive: bool
    private: bool

    @property
    def part(self) -> float:
        """The part of the limit."""
        return self.used / self.limit

    @property
    def rate(self) -> float | None:
        """Samples like this that fill the limit [1/s]; None where they take nothing."""
        return self.limit / self.used / self.window if self.used else None


@dataclass(frozen=True, slots=True)
class Worth:
    """What an information type makes of the sample, by the key expression that is `covering`."""

    type: InformationType
    covering: Covering
    later: tuple[Covering, ...]
    """Those of other types, which come later and so do not count."""
    captured: Mapping[str, str]
    features: tuple[FeatureValue, ...]
    weight: Worked
    scale: Worked
    utility: MessageUtility
    lifetime: Lifetime
    """How the utility goes by, before it is scaled."""
    failed_utility: bool
    """Whether the function of a `python` utility fails for these features, so that those by default hold."""

    @property
    def factor(self) -> float:
        """Weight × scale."""
        return self.weight.value * self.scale.value

    @property
    def value(self) -> float:
        """What the sample is worth in its first second to each who has it from the start [utility·s]."""
        return self.factor * self.lifetime.first_second

    def data(self) -> dict[str, Any]:
        """Return all of it as plain JSON data."""
        return {
            "type": self.type.name,
            "covering": self.covering.data(),
            "later": [each.data() for each in self.later],
            "captured": dict(self.captured),
            "features": [asdict(each) for each in self.features],
            "weight": asdict(self.weight),
            "scale": asdict(self.scale),
            "factor": self.factor,
            "utility": {"kind": kind_of(self.utility), "failed": self.failed_utility, **asdict(self.lifetime)},
            "value": self.value,
            "aggregation": combined(self.type.aggregation),
            "mode": self.type.mode,
            "bypass": self.type.bypass,
            "min_rate": self.type.guarantee.min_rate,
            "max_age": self.type.guarantee.max_age,
        }


@dataclass(frozen=True, slots=True)
class Explanation:
    """What specs make of a sample of `key` with `size` [B] for so many `receivers`.

    Without `worth` no type covers it and it passes at once; `near` are then those that nearly do.
    """

    key: str
    size: int
    receivers: int
    worth: Worth | None
    near: tuple[Near, ...]
    uses: tuple[Use, ...]

    def data(self) -> dict[str, Any]:
        """Return all of it as plain JSON data."""
        return {
            "key": self.key,
            "size": self.size,
            "receivers": self.receivers,
            "worth": None if self.worth is None else self.worth.data(),
            "near": [asdict(each) for each in self.near],
            "uses": [asdict(use) | {"part": use.part, "rate": use.rate} for use in self.uses],
        }


def explain(
    specs: SpecSet,
    key: str,
    payload: AnyPayload,
    attachment: AnyPayload | None = None,
    *,
    size: int | None = None,
    receivers: int = 1,
) -> Explanation:
    """Explain a sample; its `size` [B] is that of payload and attachment unless it is given."""
    sample = Sample(key, payload, attachment)
    if size is None:
        size = len(sample.payload) + (0 if attachment is None else len(sample.attachment))
    of, keys = specs.specs.match(key), list(_keys(specs))
    worth = None if of is None else _worth(of, sample, [each for each in keys if _includes(each[1], key)])
    near = nearest(key, [each.expression for each, _ in keys], NEAREST) if of is None else ()
    return Explanation(key, size, receivers, worth, near, tuple(_uses(specs, size, receivers)))


def _worth(of: InformationType, sample: Sample, covering: list[tuple[Covering, KeyFormat]]) -> Worth:
    first, format_ = covering[0]
    features = tuple(_feature(of, name, feature, sample) for name, feature in of.features)
    values = {each.name: each.value for each in features}
    utility = of.utility_of(values)
    return Worth(
        type=of,
        covering=first,
        later=tuple(each for each, _ in covering if each.type != of.name),
        captured=format_.captured(sample.key),
        features=features,
        weight=_worked(of.weighing, {**values, **of.captured}),
        scale=_worked(of.expression, {**values, **of.captured}),
        utility=utility,
        lifetime=Lifetime.of(utility),
        failed_utility="utility" in of.failures.counts(),
    )


def _keys(specs: SpecSet) -> Iterator[tuple[Covering, KeyFormat]]:
    """Yield all key expressions in the order in which a key is looked for."""
    for file in specs.files:
        for index, (table, of) in enumerate(zip(file.tables.information_type, file.types, strict=True)):
            for number, (written, format_) in enumerate(zip(table.keys, of.formats, strict=True)):
                line = file.source.line_of(("information_type", index, "keys", number))
                yield Covering(of.name, written, file.path, line), format_


def _includes(format_: KeyFormat, key: str) -> bool:
    return zenoh.KeyExpr(format_.expression).includes(zenoh.KeyExpr(key))


def _feature(of: InformationType, name: str, feature: Feature, sample: Sample) -> FeatureValue:
    """Measure a feature as the daemon does, but keep the reason where that fails."""
    used = isinstance(of.utility, Custom) or name in of.expression.names | of.weighing.names
    first = isinstance(feature, Change) and not feature.compares(sample.key)
    try:
        value = float(feature.measure(sample))
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # noqa: BLE001 - payloads are broken in every way
        return FeatureValue(name, feature.default, reason_of(error, feature, sample), used)
    if not isfinite(value):
        return FeatureValue(name, feature.default, f"{value} is no finite number", used)
    return FeatureValue(name, value, "there is no image before it to compare it with" if first else None, used)


def _worked(expression: Expression, values: Mapping[str, float | str]) -> Worked:
    """Evaluate an expression as `InformationType.scale` does."""
    filled = expression.filled(values, figure)
    try:
        value = expression.evaluate(values)
    except ExpressionError as error:
        return Worked(expression.text, filled, 1.0, str(error))
    return Worked(expression.text, filled, max(0.0, value), "is below 0" if value < 0.0 else None)


def _uses(specs: SpecSet, size: int, receivers: int) -> Iterator[Use]:
    for each in specs.specs.constraints:
        measure = each.measure
        used = measure.use(size, receivers, own=True)
        yield Use(each.name, measure.unit, measure.window, measure.limit, used, each.least < 1.0, measure.private)


def kind_of(utility: MessageUtility | None) -> str:
    """Return the kind of a utility as specs write it; of a Python function its import path, too."""
    return f"python {utility.name}" if isinstance(utility, Custom) else type(utility).__name__.lower()


def combined(aggregation: Aggregation | AggregationModel) -> str:
    """Return the name of an aggregation as specs write it."""
    if isinstance(aggregation, Aggregation):
        return str(aggregation)
    return f"python {type(aggregation).__module__}:{type(aggregation).__qualname__}"


def figure(value: float | str) -> str:
    """Write a number with four digits, a whole one with all of them; text in quotes."""
    if isinstance(value, str):
        return f"'{value}'"
    text = f"{value:.0f}" if value == int(value) and abs(value) < 1e9 else f"{value:.4g}"
    return f"({text})" if value < 0.0 else text
