"""Schedules that specs give."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter

from planner.errors import ProblemError
from tests.utility_specs import outlooks
from utility_specs.schedules import (
    AnySchedule,
    PeriodicRule,
    PoissonRule,
    PythonRule,
    TimesRule,
    rule_of,
)


@pytest.mark.parametrize(
    ("said", "rule"),
    [
        ("auto", None),
        ({"kind": "periodic", "period": "500 ms"}, PeriodicRule(0.5)),
        ({"kind": "periodic", "period": 2, "phase": "0 s"}, PeriodicRule(2.0, 0.0)),
        ({"kind": "periodic", "period": 2, "phase": "1e15 s"}, PeriodicRule(2.0, 0.0)),
        ({"kind": "poisson", "rate": "0.2 Hz"}, PoissonRule(5.0)),
        ({"kind": "poisson", "interval": "1 min"}, PoissonRule(60.0)),
        ({"kind": "times", "times": [0, "500 ms", 3], "every": "10 s"}, TimesRule((0.0, 0.5, 3.0), 10.0)),
        (
            {"kind": "python", "function": "tests.utility_specs.outlooks:every_two"},
            PythonRule("tests.utility_specs.outlooks:every_two", outlooks.every_two),
        ),
    ],
)
def test_quantities_are_written_with_units(said, rule):
    """Inside, all are seconds."""
    assert rule_of(TypeAdapter(AnySchedule).validate_python(said)) == rule


def test_listed_times_begin_at_the_first_and_come_again():
    """What stands in the list is counted from its first time; without `every` it ends."""
    cycle = TimesRule((1.0, 1.5, 4.0), 10.0)
    assert [cycle.at(n) for n in range(5)] == [0.0, 0.5, 3.0, 10.0, 10.5]
    assert cycle.gaps == (0.5, 2.5, 7.0)
    once = TimesRule((1.0, 1.5))
    assert [once.at(n) for n in range(3)] == [0.0, 0.5, math.inf]
    assert once.gaps == (0.5,)
    assert TimesRule((7.0,)).gaps == ()


@given(st.lists(st.integers(0, 1000), min_size=1, max_size=20, unique=True), st.integers(1, 100), st.floats(0.0, 1e4))
def test_the_first_sample_after_a_time_is_found(times, rest, elapsed):
    """No sample before it is later, and it is."""
    ordered = tuple(map(float, sorted(times)))
    for every in (None, ordered[-1] - ordered[0] + rest):
        rule = TimesRule(ordered, every)
        number = rule.first_after(elapsed)
        assert rule.at(number) > elapsed
        assert number == 0 or rule.at(number - 1) <= elapsed


def test_a_functions_answer_is_put_in_order():
    """Only what lies between the last sample and the end is an answer."""
    rule = PythonRule("mission:times", lambda _times, _until: [9.0, 3.0, 1.0, 4.0])
    assert rule.next_times([0.0, 1.0], 5.0) == [3.0, 4.0]


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (outlooks.never_finite, "x:y returned a time that is not finite"),
        (outlooks.leaving, "x:y failed: SystemExit: no"),
        (outlooks.cancelled, "x:y failed: CancelledError: late"),
        (outlooks.no_list, "x:y failed: TypeError"),
    ],
)
def test_a_function_that_fails_says_how(function, message):
    """Whatever it raises or returns, one kind of error comes out."""
    with pytest.raises(ProblemError, match=message):
        PythonRule("x:y", function).next_times([0.0], 5.0)
