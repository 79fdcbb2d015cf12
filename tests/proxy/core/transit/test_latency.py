"""The line through what messages took."""

from statistics import median

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxy.core.transit.latency import Latency, LatencyFit, middle, weighted_median
from proxy.core.transit.tuning import TUNING

SEEDS = st.integers(0, 10_000)
SIZES = (100, 900, 5_000, 40_000)


def fitted(messages):
    fit = LatencyFit()
    for at, (size, took) in enumerate(messages):
        fit.observe(at * 0.1, size, took)
    return fit


def test_few_messages_tell_nothing():
    """Two could both be outliers."""
    assert LatencyFit().line is None
    assert fitted([(100, 0.1)] * 2).line is None
    assert fitted([(100, 0.1)] * 3).line == Latency(0.1, 0.0)


@given(fixed=st.floats(0.001, 1.0), per_byte=st.floats(0.0, 1e-4), seed=SEEDS)
def test_a_fixed_part_and_one_per_byte_are_told_apart(fixed, per_byte, seed):
    """From messages of several sizes, in any order."""
    sizes = np.random.default_rng(seed).choice(SIZES, 60)
    line = fitted([(int(size), fixed + per_byte * size) for size in sizes]).line
    assert line.fixed == pytest.approx(fixed, rel=1e-6, abs=1e-9)
    assert line.per_byte == pytest.approx(per_byte, rel=1e-6, abs=1e-12)
    assert line.of(1000) == pytest.approx(fixed + per_byte * 1000)


@given(fixed=st.floats(0.001, 0.2), per_byte=st.floats(1e-6, 1e-5), wait=st.floats(0.5, 9.0), seed=SEEDS)
def test_outliers_alter_little(fixed, per_byte, wait, seed):
    """A quarter of the messages of each size may have waited for seconds; the others jitter by a tenth."""
    rng = np.random.default_rng(seed)
    messages = [
        (size, (fixed + per_byte * size) * rng.uniform(0.9, 1.1) + (wait if (number + at) % 4 == 0 else 0.0))
        for number in range(TUNING.messages_of_a_size)
        for at, size in enumerate(SIZES)
    ]
    line, longest = fitted(messages).line, fixed + per_byte * SIZES[-1]
    for size in SIZES:
        assert line.of(size) == pytest.approx(fixed + per_byte * size, rel=0.2, abs=0.05 * longest)


@given(st.floats(0.0, 2.0), st.integers(1, 100_000), SEEDS)
def test_where_sizes_hardly_differ_all_is_the_fixed_part(took, size, seed):
    """However the little that they differ goes with the time."""
    rng = np.random.default_rng(seed)
    line = fitted([(int(size * rng.uniform(1.0, 1.2)), took + rng.uniform(0.0, 0.01)) for _ in range(40)]).line
    assert line.per_byte == 0.0
    assert took <= line.fixed <= took + 0.01


@given(st.lists(st.tuples(st.integers(0, 2**40), st.floats(0.0, 10.0)), min_size=3, max_size=200))
def test_no_message_takes_less_than_no_time(messages):
    """And none takes less for being larger; what is remembered is bounded."""
    fit = fitted(messages)
    assert fit.line.fixed >= 0.0
    assert fit.line.per_byte >= 0.0
    assert sum(len(each) for each in fit._classes.values()) <= TUNING.size_classes * TUNING.messages_of_a_size


@given(st.lists(st.tuples(st.integers(1024, 2047), st.floats(0.0, 0.1)), min_size=3, max_size=16))
def test_of_one_class_all_is_the_middle(messages):
    """As for sizes of several classes that are too few to tell a slope."""
    line = fitted(messages).line
    assert line.of(10_000) == pytest.approx(middle([took for _, took in messages]))


def test_large_messages_that_are_quicker_than_small_ones_make_no_slope():
    """Something else than their size must have kept the small ones."""
    assert fitted([(100, 0.2), (10_000, 0.1)] * 5).line.per_byte == 0.0


def test_a_line_that_would_start_below_zero_starts_at_zero():
    """Where the slope grows with size, as on a channel that chokes on large messages."""
    line = fitted([(1_000, 0.0), (10_000, 0.01), (20_000, 0.4)] * 5).line
    assert line.fixed == 0.0
    assert line.per_byte > 0.0


def test_a_size_that_is_seldom_sent_is_not_forgotten_because_of_the_others():
    """Until it is too long ago."""
    fit = fitted([(40_000, 0.5)] * 3)
    for number in range(200):
        fit.observe(1.0 + number * 0.1, 100, 0.1)
    assert fit.line.of(40_000) == pytest.approx(0.5)
    fit.observe(1.0 + TUNING.messages_for, 100, 0.1)
    assert fit.line == Latency(0.1, 0.0)


def test_what_was_learnt_in_a_queue_is_forgotten_once_it_has_drained():
    """Several in a row tell, of any size that came before; also of those that nobody sends any more."""
    fit = fitted([(120, 1.2), (300, 1.3), (40_000, 1.5)] * 8)
    for number, size in enumerate((300, 40_000)):
        fit.observe(3.0 + number, size, 0.02)
        assert fit.line.of(120) > 1.0
    fit.observe(5.0, 300, 0.02)
    assert fit.line.of(120) == pytest.approx(0.02)


def test_that_one_came_quickly_does_not_tell_that_a_queue_has_drained():
    """Those that come between must be quick, too, and by much."""
    fit = fitted([(120, 0.3)] * 8)
    for number in range(20):
        fit.observe(2.0 + number, 120, 0.02 if number % 3 else 0.3)
    assert len(fit._recent(fit._classes[7])) == TUNING.messages_of_a_size
    fit = fitted([(120, 0.3)] * 8)
    for number in range(3):
        fit.observe(2.0 + number, 120, 0.15)
    assert fit.line.fixed == pytest.approx(0.3)


def test_the_weighted_median_halves_the_weight():
    """Between two values that share the middle lies their mean."""
    assert weighted_median([(1.0, 1.0), (2.0, 1.0)]) == 1.5
    assert weighted_median([(3.0, 5.0), (1.0, 1.0), (2.0, 1.0)]) == 3.0
    assert weighted_median([(7.0, 1.0)]) == 7.0


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=40))
def test_the_middle_is_the_median(values):
    """Of an even number of values the mean of the two in the middle."""
    assert middle(values) == median(values)
