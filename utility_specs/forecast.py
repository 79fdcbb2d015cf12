"""What a feature of a stream's next messages will be, as far as its past tells (§4.3).

`last` is the paper's: the next resembles the last, which is right surprisingly often. `auto` learns for every stream
and feature which of the others would have been least wrong.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import isfinite
from typing import Annotated, Any, Literal, Protocol

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, field_validator

from planner.errors import ProblemError
from utility_specs.effort import Sparingly
from utility_specs.imports import imported

TRENDING = 8
"""So many of the last values tell a trend."""


class Method(Protocol):
    """Predicts a feature from its values in the same stream's past messages."""

    @property
    def kind(self) -> str:
        """The name of the method, as specs write it."""

    @property
    def steady(self) -> bool:
        """Whether it predicts the same whenever the message comes."""

    def predict(self, times: Sequence[float], values: Sequence[float], t: float) -> float:
        """Return the value of a message to be generated at `t` [s]; there is a past, the oldest first.

        Raises ProblemError when it fails.
        """


@dataclass(frozen=True, slots=True)
class Last:
    """The next message resembles the last one."""

    kind: str = "last"
    steady: bool = True

    def predict(self, times: Sequence[float], values: Sequence[float], t: float) -> float:  # noqa: ARG002 - whenever
        """Return the last value."""
        return values[-1]


@dataclass(frozen=True, slots=True)
class Mean:
    """The next messages are about as the past ones were."""

    kind: str = "mean"
    steady: bool = True

    def predict(self, times: Sequence[float], values: Sequence[float], t: float) -> float:  # noqa: ARG002 - whenever
        """Return the mean of all values."""
        return sum(values) / len(values)


@dataclass(frozen=True, slots=True)
class Trend:
    """What rises goes on rising, for as long as it was seen to rise, and then stays."""

    kind: str = "trend"
    steady: bool = False

    def predict(self, times: Sequence[float], values: Sequence[float], t: float) -> float:
        """Return where the straight line through the last values arrives."""
        times, values = times[-TRENDING:], values[-TRENDING:]
        mean_t, mean = sum(times) / len(times), sum(values) / len(values)
        under = sum([(at - mean_t) ** 2 for at in times])
        if under <= 0.0:
            return values[-1]
        over = sum([(at - mean_t) * value for at, value in zip(times, values, strict=True)])
        ahead = min(t, 2.0 * times[-1] - times[0])
        return mean + over / under * (ahead - mean_t)


@dataclass(frozen=True, slots=True)
class PythonMethod:
    """What a function of the operator's says."""

    path: str
    function: Callable[[Sequence[float], Sequence[float], float], Any]
    kind: str = "python"
    steady: bool = False

    def predict(self, times: Sequence[float], values: Sequence[float], t: float) -> float:
        """Return what the function returns; raises ProblemError when that is no finite number."""
        try:
            value = float(self.function(list(times), list(values), t))
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            raise ProblemError(f"{self.path} failed: {type(error).__name__}: {error}") from error
        if not isfinite(value):
            raise ProblemError(f"{self.path} returned {value}, which is not finite")
        return value


LAST, MEAN, TREND = Last(), Mean(), Trend()
AUTO: tuple[Method, ...] = (LAST, MEAN, TREND)
"""`auto` chooses among these; while it cannot tell, the first."""
_METHODS: Mapping[str, tuple[Method, ...]] = {"last": (LAST,), "mean": (MEAN,), "trend": (TREND,), "auto": AUTO}


@dataclass(frozen=True, slots=True)
class FeatureForecast:
    """How the features of a type are forecast: by one of the `methods` for most, by those of `by_feature` for some."""

    methods: tuple[Method, ...] = (LAST,)
    by_feature: Mapping[str, tuple[Method, ...]] = field(default_factory=dict)

    def of(self, feature: str) -> tuple[Method, ...]:
        """Return the methods that may forecast a feature."""
        return self.by_feature.get(feature, self.methods)

    @property
    def of_scale(self) -> tuple[Method, ...]:
        """The methods for the scale itself, where features are not known: the types' own, or of several `auto`'s."""
        said = set(self.by_feature.values()) or {self.methods}
        methods = next(iter(said)) if len(said) == 1 else AUTO
        return tuple(each for each in methods if not isinstance(each, PythonMethod)) or (LAST,)

    @property
    def plain(self) -> bool:
        """Whether every message is expected to be as the last one."""
        return all(methods == (LAST,) for methods in (self.methods, *self.by_feature.values()))


class PythonForecast(BaseModel):
    """The function `python`, written `package.module:name`, forecasts."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    python: str = Field(
        description="package.module:name; it gets times, values and a time to come, and returns a value"
    )

    @field_validator("python")
    @classmethod
    def _importable(cls, path: str) -> str:
        imported(path)
        return path

    def methods(self) -> tuple[Method, ...]:
        """Return the method, tried with two values a second apart; raises ProblemError when the function fails."""
        method = PythonMethod(self.python, imported(self.python))
        method.predict((0.0, 1.0), (0.0, 0.0), 2.0)
        return (method,)


def _form(value: Any) -> str:
    return "table" if isinstance(value, dict | PythonForecast) else "name"


AnyMethod = Annotated[
    Annotated[Literal["last", "mean", "trend", "auto"], Tag("name")] | Annotated[PythonForecast, Tag("table")],
    Discriminator(_form),
]
"""A method by its name, or a table for a function of the operator's."""


def _whole_form(value: Any) -> str:
    if isinstance(value, PythonForecast) or (isinstance(value, dict) and set(value) == {"python"}):
        return "table"
    return "features" if isinstance(value, dict) else "name"


AnyFeatureForecast = Annotated[
    Annotated[Literal["last", "mean", "trend", "auto"], Tag("name")]
    | Annotated[PythonForecast, Tag("table")]
    | Annotated[dict[str, Annotated[AnyMethod, Sparingly]], Tag("features")],
    Discriminator(_whole_form),
]
"""One method for all features, or a table of methods by feature; `last` for those it leaves out."""


def forecast_of(said: str | PythonForecast | Mapping[str, str | PythonForecast]) -> FeatureForecast:
    """Return how features are forecast; raises ProblemError when a function of the operator's fails."""
    if isinstance(said, Mapping):
        return FeatureForecast((LAST,), {name: _methods_of(each) for name, each in said.items()})
    return FeatureForecast(_methods_of(said))


def _methods_of(said: str | PythonForecast) -> tuple[Method, ...]:
    return said.methods() if isinstance(said, PythonForecast) else _METHODS[said]
