"""Numbers from gaps."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.forecast.gaps import base_of, faster, gaps_of, numbered, slower, spread
from proxy.core.forecast.rhythm import Rhythm
from tests.proxy.core.streams import periodic, poisson

SECOND = Rhythm(1.0, 0.0, 0, 0.0, 16)


@given(st.lists(st.integers(1, 4), min_size=1, max_size=20), st.floats(0.01, 100.0))
def test_gaps_near_multiples_of_the_period_hold_losses(steps, period):
    """Numbers of a grid are those of its places."""
    places = [0]
    for step in steps:
        places.append(places[-1] + step)
    assert numbered([5.0 + place * period for place in places], period) == [
        (place, 5.0 + place * period) for place in places
    ]


def test_the_base_is_what_the_shorter_gaps_have_in_common():
    """Most gaps may hold losses, and one may be shorter than the period."""
    assert base_of([2.0, 1.0, 2.0, 3.0, 1.0]) == 1.0
    assert base_of([1.0]) == 1.0
    assert base_of([0.3, 1.0, 1.0, 1.0, 1.0, 2.0]) == 1.0


@pytest.mark.parametrize(
    ("gaps", "shorter"),
    [
        ([1.0, 1.0, 0.3, 0.3], 0.3),
        ([1.0, 1.0, 0.3, 0.7], None),
        ([1.0, 1.0, 0.1, 0.5], None),
        ([1.0, 2.0, 1.0], None),
    ],
)
def test_two_short_gaps_that_are_alike_hint_at_a_shorter_period(gaps, shorter):
    """One late sample makes one short gap, and one sample too many makes two that differ."""
    times = [sum(gaps[:i]) for i in range(len(gaps) + 1)]
    assert faster(times, SECOND) == (None if shorter is None else pytest.approx(shorter))


@pytest.mark.parametrize(
    ("gaps", "lost", "longer"),
    [
        ([1.0, 1.0, 2.5, 2.5, 2.5], 0.3, True),
        ([1.0, 1.0, 2.0, 2.0, 2.0], 0.03, True),
        ([1.0, 1.0, 2.0, 2.0, 2.0], 0.3, False),
        ([2.0] * 5, 0.3, True),
        ([1.0, 1.0, 2.0, 3.0, 2.0], 0.03, False),
        ([1.0, 1.0, 1.1, 1.1, 1.1], 0.03, False),
    ],
)
def test_long_gaps_are_losses_until_that_is_unlikely(gaps, lost, longer):
    """Three that are no multiples of the period are another one; of multiples it depends on what else was lost."""
    assert slower([sum(gaps[:i]) for i in range(len(gaps) + 1)], SECOND, lost) is longer


def test_random_gaps_deviate_and_those_of_a_rhythm_do_not():
    """Whatever is missing of either."""
    random, regular = list(enumerate(poisson(400, seed=2))), list(enumerate(periodic(400, jitter=0.1, seed=2)))
    for step in (1, 3, 10):
        assert spread(random[::step]) == pytest.approx(0.7, abs=0.25)
        assert spread(regular[::step]) < 0.15
    assert gaps_of([1.0, 3.0, 4.0]) == [2.0, 1.0]
