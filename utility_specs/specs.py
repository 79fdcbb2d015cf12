"""Specs as the daemon uses them: frozen, checked, swapped as a whole."""

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from threading import Lock
from typing import Any, Protocol, Self, cast

import zenoh

from planner.errors import ProblemError
from planner.measures import Measure
from planner.problem import MARKOVIAN, Aggregation, AggregationModel
from planner.utility import Custom, MessageUtility
from utility_specs.errors import ExpressionError
from utility_specs.expressions import Expression
from utility_specs.features import AnyPayload, Feature, Sample
from utility_specs.features.pace import Pace, Paces
from utility_specs.forecast import FeatureForecast
from utility_specs.key_formats import KeyFormat, values_of
from utility_specs.rules import FALLBACK, FLOOR, NO_GUARANTEE, Deletes, Fallback, Guarantee, Queries, TypeMode
from utility_specs.schedules import ScheduleRule

MATCHES_KEPT = 4096
"""Keys whose information type is remembered."""

LARGEST_SCALE = 1e15
"""No sample is worth more: robots do not tell each other of such a scale."""

UTILITIES_KEPT = 256
"""Combinations of features whose tabulated `python` utility each type remembers."""


class Background(Protocol):
    """Where features are computed that take longer than they may, and the clock that finds out which."""

    def now(self) -> float:
        """Return the time [s]."""

    def later(self, job: Callable[[], object]) -> bool:
        """Run the job soon, on another thread; whether there is room for it."""

    def within(self, patience: float, job: Callable[[], object]) -> bool:
        """Run the job soon, and wait so long for it at most [s]; whether there is room for it."""


class Failures:
    """How often each feature, weight, scale, `python` utility or forecast had to be replaced by its default."""

    def __init__(self) -> None:
        self._counts: Counter[str] = Counter()
        self._lock = Lock()

    def note(self, what: str) -> None:
        """Count one failure of a feature (by name), of `weight`, `scale`, `utility`, `forecast` or `schedule`."""
        with self._lock:
            self._counts[what] += 1

    def counts(self) -> dict[str, int]:
        """Return all counts above 0."""
        with self._lock:
            return dict(self._counts)


@dataclass(frozen=True, slots=True)
class ConstraintSpec:
    """A limit on what may be sent in any window (Eq. 5 and 6), and the measure of what a message uses of it.

    `least` is the part of the limit that holds whatever the channel does: below 1 the limit is adaptive.
    """

    name: str
    measure: Measure
    least: float = 1.0


@dataclass(frozen=True, slots=True)
class InformationType:
    """What a spec says about a group of keys; each key of each robot is a stream of its own.

    `utility` is that of samples with the default features. `captured` are the chunks that a stream's key captures, as
    expressions know them: `Specs.match` sets them.
    """

    name: str
    formats: tuple[KeyFormat, ...]
    aggregation: Aggregation | AggregationModel
    weighing: Expression
    utility: MessageUtility
    expression: Expression
    features: tuple[tuple[str, Feature], ...]
    forecast: FeatureForecast
    schedule: ScheduleRule | None = None
    """When its streams generate; None: find it out."""
    mode: TypeMode | None = None
    """What is done with decisions, if not what the daemon does with all."""
    bypass: bool = False
    """Whether its samples go at once, whatever the limits."""
    guarantee: Guarantee = NO_GUARANTEE
    deletes: Deletes = "bypass"
    queries: Queries = "pass"
    captured: Mapping[str, float | str] = field(default_factory=dict)
    failures: Failures = field(default_factory=Failures, repr=False, compare=False)
    paces: Paces = field(default_factory=Paces, repr=False, compare=False)
    _tabulated: Any = field(init=False, repr=False, compare=False)
    _constant: list[float] = field(default_factory=list, init=False, repr=False, compare=False)
    """The scale of all samples where they have no features, once it is known."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "_tabulated", lru_cache(UTILITIES_KEPT)(self._tabulate))

    @property
    def keys(self) -> tuple[str, ...]:
        """The key expressions that it covers."""
        return tuple(each.expression for each in self.formats)

    @property
    def weight(self) -> float:
        """The weight of samples with the default features; 1 where it depends on a key that is not known."""
        try:
            return max(0.0, self.weighing.evaluate({**self.completed({}), **self.captured}))
        except ExpressionError:
            return 1.0

    @property
    def planned(self) -> bool:
        """Whether its samples are decided on at all; what is not covers its keys, but is traffic like any other."""
        return not self.bypass and self.mode != "pass"

    @property
    def markovian(self) -> bool:
        """Whether only the sample received last counts (§3.2.2), so that a newer one supersedes all before it."""
        return isinstance(self.aggregation, Aggregation) and self.aggregation in MARKOVIAN

    @property
    def needs_payload(self) -> bool:
        """Whether any feature reads more than the key; if not, an empty payload will do."""
        return any(feature.reads_payload for _, feature in self.features)

    def scale(self, features: Mapping[str, float]) -> float:
        """Return weight × expression, which multiplies the utility of a message; always from 0 to `LARGEST_SCALE`.

        Features that are not given take their defaults. What is below 0 means: worth nothing. What has no finite
        value is taken as 1 and counted as a failure.
        """
        if not self.features and self._constant:  # most types: their samples are all worth the same
            return self._constant[0]
        values = {**self.completed(features), **self.captured}
        weight = self._factor("weight", self.weighing, values)
        scale = weight * self._factor("scale", self.expression, values)
        if math.isfinite(scale):
            scale = min(scale, LARGEST_SCALE)
            if not self.failures.counts():
                self._constant[:] = [scale]
            return scale
        self.failures.note("scale")
        return min(weight, LARGEST_SCALE)

    def _factor(self, what: str, expression: Expression, values: Mapping[str, float | str]) -> float:
        try:
            return max(0.0, expression.evaluate(values))
        except ExpressionError:
            self.failures.note(what)
            return 1.0

    def utility_of(self, features: Mapping[str, float]) -> MessageUtility:
        """Return the message utility of a sample; features that are not given take their defaults.

        Only a `python` utility knows features, and numbers that the key has captured. Where its function fails, that
        is counted and the defaults hold.
        """
        if not isinstance(self.utility, Custom):
            return self.utility
        numbers = {name: value for name, value in self.captured.items() if isinstance(value, float)}
        utility: MessageUtility = self._tabulated(tuple((self.completed(features) | numbers).items()))
        return utility

    def told(self, features: Mapping[str, float]) -> tuple[float, ...]:
        """Return what other robots need of a sample's features to value it: all for a `python` utility, else none."""
        if not isinstance(self.utility, Custom):
            return ()
        return tuple(self.completed(features).values())

    def heard(self, values: Sequence[float]) -> dict[str, float]:
        """Return the features that another robot told so; none where its type has other features."""
        if len(values) != len(self.features):
            return {}
        return {name: value for (name, _), value in zip(self.features, values, strict=True)}

    def _tabulate(self, features: tuple[tuple[str, float], ...]) -> MessageUtility:
        try:
            return replace(cast("Custom", self.utility), features=dict(features))
        except ProblemError:
            self.failures.note("utility")
            return self.utility

    def completed(self, features: Mapping[str, float]) -> dict[str, float]:
        """Return all features, those that are not given by default."""
        return {name: features.get(name, feature.default) for name, feature in self.features}

    def extracts_within(self, key: str, most: float) -> bool:
        """Whether the features of a sample of a key are known to take at most so long each [s]."""
        return all(
            not feature.reads_payload
            or (feature.ends and self.paces.of(name, key, feature.default).quick(min(most, feature.budget)))
            for name, feature in self.features
        )

    def extract(
        self,
        key: str,
        payload: AnyPayload,
        attachment: AnyPayload | None = None,
        background: Background | None = None,
    ) -> dict[str, float]:
        """Return all features of a sample; one that cannot be computed takes its default and is counted.

        With a `background` a feature that takes longer than its budget is computed there, as often as the budget
        allows; until then its last value of the stream holds, which is counted, too. So is the first one, of which
        nobody knows what it takes, and each one that may never come to its end: it is waited for as long as its budget
        allows, while there is room for it.
        """
        if not self.features:
            return {}
        sample = Sample(key, payload, attachment)
        return {name: self._value(name, feature, sample, background) for name, feature in self.features}

    def _value(self, name: str, feature: Feature, sample: Sample, background: Background | None) -> float:
        if background is None or not feature.reads_payload:
            return self._measured(name, feature, sample)
        pace = self.paces.of(name, sample.key, feature.default)
        timed = partial(self._timed, name, feature, sample, background, pace)
        if feature.ends and pace.quick(feature.budget):
            return timed()
        if pace.due(feature.budget):
            awaited = pace.cost is None or pace.quick(feature.budget)
            if not (background.within(feature.budget, timed) if awaited else background.later(timed)):
                pace.refused()
            elif not pace.under_way:
                return pace.value
        self.paces.hold(name)
        return pace.value

    def _timed(self, name: str, feature: Feature, sample: Sample, background: Background, pace: Pace) -> float:
        begin = background.now()
        value = self._measured(name, feature, sample)
        pace.took(background.now() - begin, value)
        return value

    def _measured(self, name: str, feature: Feature, sample: Sample) -> float:
        try:
            value = float(feature.measure(sample))
        except KeyboardInterrupt:
            raise
        except BaseException:  # noqa: BLE001 - the data path survives any payload and any feature
            value = math.nan
        if math.isfinite(value):
            return value
        self.failures.note(name)
        return feature.default


@dataclass(frozen=True, slots=True)
class Specs:
    """All specs in force. `generation` is a hash of what they say: equal specs have equal generations."""

    types: tuple[InformationType, ...]
    constraints: tuple[ConstraintSpec, ...]
    generation: str
    fallback: Fallback = FALLBACK
    floor: float = FLOOR
    """Part of every limit that traffic without a spec leaves to what types cover."""
    texts: tuple[tuple[str, str], ...] = field(default=(), repr=False, compare=False)
    """The files that they come from, in their order: name and text of each."""
    _matching: Any = field(init=False, repr=False, compare=False)

    @property
    def modes(self) -> frozenset[TypeMode | None]:
        """The modes that types have of their own; None for those that have none."""
        return frozenset(each.mode for each in self.types)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_matching", lru_cache(MATCHES_KEPT)(_matcher(self.types)))

    @classmethod
    def empty(cls) -> Self:
        """Return specs that cover nothing and limit nothing."""
        return cls((), (), "0" * 12)

    def match(self, key: str) -> InformationType | None:
        """Return the first type with a key expression that includes the key; None when no type covers it."""
        found: InformationType | None = self._matching(key)
        return found

    def planned(self, key: str) -> InformationType | None:
        """Return the type that covers the key if its samples are decided on; None when they pass."""
        covering = self.match(key)
        return covering if covering is not None and covering.planned else None

    @property
    def matches_evicted(self) -> int:
        """How many keys had to be forgotten, because there are more than `MATCHES_KEPT`."""
        cache = self._matching.cache_info()
        return int(cache.misses - cache.currsize)


def _matcher(types: tuple[InformationType, ...]) -> Callable[[str], InformationType | None]:
    """Return the search for a key's type that `Specs.match` remembers the results of.

    Where keys capture chunks, all that have the same ones share a type that knows them.
    """
    formats = [(zenoh.KeyExpr(each.expression), each, of) for of in types for each in of.formats]

    @lru_cache(MATCHES_KEPT)
    def knowing(place: int, captured: tuple[tuple[str, str], ...]) -> InformationType:
        return replace(formats[place][2], captured=values_of(dict(captured)))

    def match(key: str) -> InformationType | None:
        try:
            concrete = zenoh.KeyExpr(key)
        except zenoh.ZError:
            return None
        for place, (expression, written, each) in enumerate(formats):
            if expression.includes(concrete):
                return knowing(place, tuple(written.captured(key).items())) if written.captures else each
        return None

    return match
