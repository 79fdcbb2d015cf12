"""Message utility by a Python function."""

import math
import sys
from asyncio import CancelledError
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner import Custom, Exponential, Linear, Polynomial, ProblemError, Video
from tests.planner.utility.kinds import decay, spans

SMOOTH = [*(Exponential(1.0, tau) for tau in (0.1, 1.0, 10.0)), Linear(1.0, 0.2), Video(), Polynomial(1.0, 3.0)]


@given(st.sampled_from(SMOOTH), st.sampled_from([10.0, 60.0]), spans)
def test_tabulated_integrals_are_those_of_the_function(utility, until, span):
    """Off by at most 0.03 % of all the function is worth, for functions without jumps."""
    start, end = (np.array([min(age, until)]) for age in span)
    whole = float(utility.integral(np.zeros(1), np.array([until]))[0])
    tabulated = Custom(lambda age, _: utility.value(age), until=until)
    assert tabulated.integral(start, end) == pytest.approx(utility.integral(start, end), abs=3e-4 * whole)


@pytest.mark.parametrize("end", [0.1, 1.0, 10.0])
def test_a_jump_is_blurred_by_one_percent_of_its_age(end):
    """A function may return booleans; between two ages of the grid it becomes a slope."""
    tabulated = Custom(lambda age, _: age < end)
    assert tabulated.integral(np.zeros(1), np.array([60.0])) == pytest.approx([end], rel=0.0115)


def test_the_function_is_called_once_with_all_ages_and_the_features():
    """Tabulating is vectorised, and what was tabulated serves for good."""
    calls = []

    def constant(age, features):
        calls.append((age.shape, features))
        age *= 0.0
        return age + features.pop("red")

    features = {"red": 2.0}
    utility = Custom(constant, features)
    for _ in range(3):
        assert utility.integral(np.array([1.0]), np.array([3.0])) == pytest.approx([4.0])
    assert calls == [((513,), {})]
    assert utility.features == {"red": 2.0}


def test_the_last_value_holds():
    """From `until` on the function is not asked."""
    utility = Custom(lambda age, _: 10.0 - age, until=8.0)
    assert utility.value(np.array([-1.0, 0.0, 4.0, 8.0, 99.0])) == pytest.approx([0.0, 10.0, 6.0, 2.0, 2.0])
    assert utility.integral(np.array([8.0, 0.0]), np.array([18.0, 8.0])) == pytest.approx([20.0, 48.0])


def test_utilities_with_the_same_function_and_features_are_equal():
    """Features make the difference."""
    one, other = ({"worth": 1.0, "tau": tau} for tau in (1.0, 2.0))
    assert Custom(decay, one) == Custom(decay, dict(one))
    assert Custom(decay, one) != Custom(decay, other)
    assert Custom(decay, one).name == "tests.planner.utility.kinds:decay"


class Callable:
    def __call__(self, age, _features):
        return age

    def __repr__(self):
        return "Callable()"


def test_any_callable_has_a_name():
    """Partial functions and objects are called by what they print."""
    assert Custom(Callable()).name == "Callable()"
    assert "decay" in Custom(partial(decay), {"worth": 1.0, "tau": 1.0}).name


def constant(value, dtype=np.float64):
    def function(age, _features):
        return np.full(len(age), value, dtype)

    return function


def cancelled(_age, _features):
    raise CancelledError("late")


@pytest.mark.parametrize(
    ("function", "says"),
    [
        (lambda age, features: age * features["red"], "raises KeyError: 'red'"),
        (lambda _age, _features: sys.exit(3), "raises SystemExit: 3"),
        (cancelled, "raises CancelledError: late"),
        (lambda age: age, "raises TypeError: .*takes 1 positional argument"),
        (lambda _age, _features: 1.0, "returns a float, not an array with a value for every age"),
        (lambda _age, _features: None, "returns a NoneType, not an array"),
        (lambda age, _features: list(age), "returns a list, not an array"),
        (lambda age, _features: age[1:], r"returns an array of shape \(512,\) for ages of shape \(513,\)"),
        (lambda age, _features: age[:, None], r"returns an array of shape \(513, 1\)"),
        (lambda age, _features: age + 1j, "returns an array of complex128, not of real numbers"),
        (lambda age, _features: age.astype(str), "returns an array of <U32, not of real numbers"),
        (lambda age, _features: 1 / age, "returns inf at the age 0 s, not a finite number >= 0"),
        (lambda age, _features: 1 - age, "returns -0.0.* at the age 1.0.* s, not a finite number >= 0"),
        (constant(math.nan), "returns nan at the age 0 s"),
        (constant(1e308), r"returns values up to 1e\+308, too large for a finite integral"),
    ],
)
def test_a_function_that_fails_is_named_with_what_it_did(function, says):
    """The error says which function, and what was wrong with it."""
    with pytest.raises(ProblemError, match=f"^python utility: tests.planner.utility.test_custom:.*{says}"):
        Custom(function)


@pytest.mark.parametrize("until", [0.0, -1.0, math.inf, math.nan])
def test_the_table_ends_at_a_finite_age(until):
    """The error names kind, parameter and value."""
    with pytest.raises(ProblemError, match=f"python utility: until must be a finite number > 0, not {until}"):
        Custom(constant(1.0), until=until)
