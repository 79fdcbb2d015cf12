"""Which method would have forecast the features of what was seen best."""

from collections.abc import Sequence
from statistics import pstdev

from utility_specs.forecast import AUTO, Method
from utility_specs.learning.candidates import Candidate, Series

MEMORY = 16
"""Values that a method looks back on."""
YOUNG = 6
"""Errors that are counted at least before anything but the last value is proposed."""
BETTER = 0.9
"""Another method must err by less than this part of what the first one does."""


def best_method(candidates: Sequence[Candidate]) -> tuple[str, float]:
    """Return the method that errs least over all candidates, and what it errs less than `last` (a part of that).

    `last`, and 0.0, while none is a tenth better.
    """
    series = [each for candidate in candidates for each in candidate.series if len(each) > YOUNG]
    first, *others = AUTO
    last = _errors(first, series)
    by_error = {each.kind: _errors(each, series) for each in others}
    name = min(by_error, key=lambda each: by_error[each])
    if last <= 0.0 or by_error[name] >= BETTER * last:
        return first.kind, 0.0
    return name, 1.0 - by_error[name] / last


def _errors(method: Method, all_series: Sequence[Series]) -> float:
    """Return what a method errs by for the next sample, in standard deviations of each series."""
    total = 0.0
    for series in all_series:
        deviation = pstdev([value for _, value in series])
        if deviation > 0.0:
            total += _mean_error(method, series) / deviation
    return total


def _mean_error(method: Method, series: Series) -> float:
    times, values = [t for t, _ in series], [value for _, value in series]
    errors = []
    for i in range(1, len(series)):
        past = slice(max(0, i - MEMORY), i)
        errors.append(abs(method.predict(times[past], values[past], times[i]) - values[i]))
    return sum(errors) / len(errors)
