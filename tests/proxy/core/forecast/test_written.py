"""Schedules of specs over what was seen."""

import pytest

from proxy.core.forecast.patterns import Span
from proxy.core.forecast.recognition import written
from utility_specs.schedules import PeriodicRule, PoissonRule, PythonRule, TimesRule
from utility_specs.specs import Failures

PAST = [(1, 10.0), (2, 11.0), (3, 12.0)]


@pytest.mark.parametrize(
    ("rule", "kind", "period", "pause", "expected"),
    [
        (PeriodicRule(1.5), "periodic", 1.5, 1.5, [13.5, 15.0]),
        (PeriodicRule(1.5, 0.5), "periodic", 1.5, 1.5, [13.5, 15.0]),
        (PoissonRule(1.5), "poisson", 1.5, 1.5, [13.5, 15.0]),
        (TimesRule((0.0, 1.0), 2.0), "times", 1.0, 1.0, [13.0, 14.0, 15.0]),
        (TimesRule((7.0,)), "times", 0.0, 0.0, []),
        (PythonRule("x:y", lambda times, _: [times[-1] + 2.5]), "python", 9.0, 9.0, [14.5]),
    ],
)
def test_each_rule_says_when(rule, kind, period, pause, expected):
    """From what was seen comes only where it begins."""
    pattern = written(rule, PAST, 9.0, Failures())
    assert (pattern.kind, pattern.period, pattern.pause) == (kind, period, pause)
    found = pattern.expect(Span(12.0, 12.0, 15.0, 9))
    assert found == pytest.approx(expected)
    assert len(pattern.expect(Span(12.0, 12.0, 15.0, 1))) <= 1
