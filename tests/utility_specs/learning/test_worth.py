"""What samples are probably worth."""

import random

import pytest

from tests.utility_specs.learning.team import PICTURES, at_random, regular, streams_of
from utility_specs.learning import Observed
from utility_specs.learning.worth import coming, period, worth_of


def ticks(rate, seconds=20.0, payload=b"{}", key="k"):
    return regular(key, rate, lambda _: payload, seconds)


def randomly(interval, seed=1, seconds=60.0):
    return at_random("k", interval, lambda _: b"{}", seed, seconds)


def shaken():
    """A period of 0.2 s with jitter, and every fifth sample lost."""
    rng = random.Random(1)
    return [Observed(0.2 * i + rng.gauss(0, 0.02), "k", b"{}") for i in range(100) if i % 5]


def bursts():
    return [Observed(10.0 * burst + 0.1 * member, "k", b"{}") for burst in range(8) for member in range(4)]


@pytest.mark.parametrize(
    ("streams", "how"),
    [
        (streams_of(ticks(10.0)), "periodic"),
        (streams_of(ticks(0.1, 30.0)), "periodic"),
        (streams_of(shaken()), "periodic"),
        (streams_of(ticks(1.0, 1.0)), "once"),
        (streams_of(ticks(1.0, 1.0), ticks(1.0, 2.0)), "events"),
        (streams_of([Observed(t, "k", b"") for t in (1.0, 2.0, 19.0)]), "events"),
        (streams_of(randomly(4.0)), "events"),
        (streams_of(randomly(0.3)), "random"),
        (streams_of(bursts()), "bursts"),
        (streams_of(ticks(1.0), ticks(1.0), randomly(0.3)), "periodic"),
    ],
)
def test_samples_come_in_five_ways(streams, how):
    """As those of most streams do."""
    assert coming(streams) == how


def test_the_period_is_that_of_most():
    """Streams of one sample have none; of others than periodic ones it is the mean time between samples."""
    assert period(streams_of(ticks(1.0), ticks(1.0), ticks(5.0)), "periodic") == pytest.approx(1.0)
    assert period(streams_of(ticks(1.0, 1.0)), "once") == 0.0
    assert period(streams_of([Observed(t, "k", b"") for t in (0.0, 1.0, 6.0)]), "events") == 3.0


@pytest.mark.parametrize(
    ("samples", "utility", "aggregation"),
    [
        (ticks(5.0, payload=PICTURES[0]), '{ kind = "video" }', "most_recent"),
        (ticks(0.5, payload=PICTURES[0]), '{ kind = "video", a0 = "2 s", a1 = "3.3 min" }', "most_recent"),
        (ticks(10.0), '{ kind = "linear", slope = 1 }', "most_recent"),
        (ticks(1.0), '{ kind = "linear", slope = 0.1 }', "most_recent"),
        (ticks(1.0, 1.0), '{ kind = "step", lifetime = "10 min" }', "once"),
        (ticks(1.0, 2.0), '{ kind = "step", lifetime = "10 s" }', "sum"),
        (bursts(), '{ kind = "exponential", tau = "11 s" }', "most_recent"),
    ],
)
def test_utilities_suit_how_samples_come(samples, utility, aggregation):
    """Images by the logarithm of age, states as long as ten periods, single ones once, events each."""
    worth = worth_of(streams_of(samples))
    assert (worth.utility, worth.aggregation, worth.schedule) == (utility, aggregation, None)
    assert worth.why
    assert worth.combined


def test_a_random_schedule_is_written_where_it_is_clear():
    """With samples enough, and one rate for all streams."""
    sure = worth_of(streams_of(randomly(0.3)))
    assert sure.schedule.startswith('{ kind = "poisson", interval = "')
    assert sure.utility.startswith('{ kind = "exponential", tau = ')
    assert worth_of(streams_of(randomly(4.0, seconds=40.0))).schedule is None
    assert worth_of(streams_of(randomly(0.3), randomly(3.0, 2, 120.0))).schedule is None
