"""What the next samples of a stream are expected to be worth: features, or where these are not known the scale."""

from collections.abc import Mapping, Sequence

from planner.errors import ProblemError
from proxy.core.forecast.tuning import TUNING
from utility_specs.forecast import FeatureForecast, Method
from utility_specs.specs import Failures

SCALE = "scale"
"""Stands for the scale where features are not known."""


class FeatureTrack:
    """The past values of one feature of one stream, and what each method that may forecast it was wrong by."""

    def __init__(self, methods: Sequence[Method], failures: Failures) -> None:
        self._methods = tuple(methods)
        self._failures = failures
        self._times: list[float] = []
        self._values: list[float] = []
        self._errors = [0.0] * len(self._methods)
        self._judged = 0

    @property
    def method(self) -> Method:
        """The method that is used: the one that erred least, or the first while none is clearly better."""
        if self._judged < TUNING.young and len(self._methods) > 1:
            return self._methods[0]
        best = min(range(len(self._methods)), key=self._errors.__getitem__)
        return self._methods[best if self._errors[best] < TUNING.better_method * self._errors[0] else 0]

    def note(self, t: float, value: float) -> None:
        """The sample generated at `t` [s] had this value."""
        if self._times and len(self._methods) > 1:
            for i, method in enumerate(self._methods):
                error = abs(self._predicted(method, t) - value)
                self._errors[i] = TUNING.error_fade * self._errors[i] + (1.0 - TUNING.error_fade) * error
            self._judged += 1
        self._times.append(t)
        self._values.append(value)
        del self._times[: -TUNING.values], self._values[: -TUNING.values]

    def expect(self, t: float) -> float:
        """Return the value expected at `t` [s]; something was noted before."""
        return self._predicted(self.method, t)

    def _predicted(self, method: Method, t: float) -> float:
        try:
            return method.predict(self._times, self._values, t)
        except ProblemError:
            self._failures.note("forecast")
            return self._values[-1]


class Outlook:
    """All features of one stream, or its scale, at times to come."""

    def __init__(self, forecast: FeatureForecast, failures: Failures) -> None:
        self._forecast = forecast
        self._failures = failures
        self._tracks: dict[str, FeatureTrack] = {}

    def note(self, t: float, values: Mapping[str, float]) -> None:
        """A sample generated at `t` [s] had these values."""
        if values.keys() != self._tracks.keys():
            self._tracks = {name: FeatureTrack(self._methods_of(name), self._failures) for name in values}
        for name, value in values.items():
            self._tracks[name].note(t, value)

    @property
    def steady(self) -> bool:
        """Whether all that is expected is the same at all times."""
        return all(track.method.steady for track in self._tracks.values())

    @property
    def chosen(self) -> dict[str, str]:
        """The method in use by name."""
        return {name: track.method.kind for name, track in self._tracks.items()}

    def expect(self, t: float) -> dict[str, float]:
        """Return the values expected at `t` [s]."""
        return {name: track.expect(t) for name, track in self._tracks.items()}

    def _methods_of(self, name: str) -> Sequence[Method]:
        return self._forecast.of_scale if name == SCALE else self._forecast.of(name)
