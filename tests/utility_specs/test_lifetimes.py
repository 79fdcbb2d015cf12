"""How utilities go by."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.utility import Custom, Exponential, Linear, Polynomial, Power, Step, Table, Video
from utility_specs.lifetimes import YOUNG, Lifetime, sampled

ENDING = {
    "linear": (Linear(1.0, 0.5), 1.0, 2.0),
    "polynomial": (Polynomial(2.0, 3.0, 2.0), 3.0 / math.sqrt(2.0), 3.0),
    "video": (Video(0.1, 10.0), 1.0, 10.0),
    "step": (Step(1.0, 600.0), 600.0, 600.0),
    "table": (Table(((0.0, 1.0), (2.0, 0.8), (5.0, 0.0))), 3.125, 5.0),
}


@pytest.mark.parametrize("kind", ENDING)
def test_what_ends_has_a_half_life_and_an_end(kind):
    """They are where the formulas say, and the value there is 0."""
    utility, half_life, end = ENDING[kind]
    lifetime = Lifetime.of(utility)
    assert lifetime.half_life == pytest.approx(half_life, rel=1e-6)
    assert lifetime.end == pytest.approx(end, rel=1e-6)
    assert lifetime.rest == 0.0
    assert lifetime.total == pytest.approx(float(utility.integral(np.zeros(1), np.array([end]))[0]))
    assert end < lifetime.shown < 1.1 * end


def test_what_fades_is_over_at_one_percent():
    """An exponential never is nothing; its end is where hardly anything is left."""
    lifetime = Lifetime.of(Exponential(3.0, 2.0))
    assert (lifetime.young, lifetime.fresh) == (0.0, 3.0)
    assert lifetime.half_life == pytest.approx(2.0 * math.log(2.0))
    assert lifetime.end == pytest.approx(2.0 * math.log(100.0))
    assert lifetime.rest == pytest.approx(0.03, rel=1e-3)
    assert lifetime.total == pytest.approx(6.0)
    assert lifetime.first_second == pytest.approx(6.0 * (1.0 - math.exp(-0.5)))


def test_an_infinite_beginning_is_looked_at_a_little_later():
    """A power has no value at the age 0, and no end of its worth."""
    lifetime = Lifetime.of(Power(0.5))
    assert (lifetime.young, lifetime.fresh) == (YOUNG, pytest.approx(0.5 / math.sqrt(YOUNG)))
    assert lifetime.half_life == pytest.approx(4.0 * YOUNG)
    assert lifetime.first_second == pytest.approx(1.0)
    assert lifetime.end == pytest.approx(10.0, rel=1e-3)
    assert lifetime.total is not None


def test_what_keeps_its_worth_never_ends():
    """Neither half life nor end, and no total."""
    lifetime = Lifetime.of(Table(((0.0, 1.0), (2.0, 0.8))))
    assert (lifetime.half_life, lifetime.end, lifetime.total) == (None, None, None)
    assert lifetime.rest == 0.8
    assert lifetime.shown == 60.0
    halved = Lifetime.of(Table(((0.0, 1.0), (2.0, 0.4))))
    assert halved.half_life == pytest.approx(2.0 * 0.5 / 0.6)
    assert halved.shown == pytest.approx(10.0 * halved.half_life)


def test_what_is_worth_nothing_is_over_at_once():
    """There is nothing to show, and that is no error."""
    lifetime = Lifetime.of(Table(((0.0, 0.0),)))
    assert (lifetime.fresh, lifetime.half_life, lifetime.end, lifetime.total) == (0.0, None, 0.0, 0.0)
    assert lifetime.shown == 1.0


def test_what_grows_first_ends_when_it_fades_for_good():
    """A function of the operator's may be worth most later on."""
    lifetime = Lifetime.of(Custom(lambda age, _: np.where(age < 1.0, 0.0, np.exp(-age)), {}, 60.0))
    assert lifetime.fresh == 0.0
    assert 5.0 < lifetime.end < 6.0


@given(st.floats(0.01, 100.0), st.floats(0.01, 1000.0))
def test_the_ages_mean_what_they_say(u0, tau):
    """Half at the half life, little from the end on, whatever the utility."""
    utility = Exponential(u0, tau)
    lifetime = Lifetime.of(utility)
    half, end = sampled(utility, lifetime.half_life, lifetime.end, 2)
    assert half == pytest.approx(u0 / 2.0, rel=1e-6)
    assert end <= 0.01 * u0 * (1.0 + 1e-6)
