"""Who asks: robots whose next message nobody can foresee, where the answer is quick and asking affordable."""

import math
from types import SimpleNamespace

import pytest

from planner.measures import Throughput
from proxy.core.asks import asks, serves, waits_until
from proxy.core.limits import Limit


@pytest.mark.parametrize(
    ("kind", "jitter", "latency", "rate", "answer"),
    [
        ("poisson", 0.0, 0.02, 1e5, True),
        ("poisson", 0.0, 0.02, 1e3, False),
        ("poisson", 0.0, 0.5, 1e5, False),
        ("periodic", 0.1, 0.02, 1e5, True),
        ("periodic", 0.1, 0.02, 1e3, False),
        ("periodic", 0.01, 0.02, 1e5, False),
    ],
)
def test_who_asks(kind, jitter, latency, rate, answer):
    """Where the answer is quick and can be paid for: random streams, and those that deviate by more than it takes."""
    view = SimpleNamespace(peers={"a": None}, settings=SimpleNamespace(allowance=0.02))
    stream = SimpleNamespace(schedule=SimpleNamespace(kind=kind, jitter=jitter, period=1.0))
    other = SimpleNamespace(offset=SimpleNamespace(latency=latency))
    limits = (Limit("throughput", 1.0, rate, Throughput(rate, 1.0)),)
    assert asks(view, stream, other, limits) is answer


def waiting(latency=0.02, period=1.0, *, known=True, markovian=True):
    """A stream whose last sample was generated at 10.0, and who lends."""
    stream = SimpleNamespace(
        schedule=SimpleNamespace(period=period),
        information_type=SimpleNamespace(markovian=markovian),
        newest=SimpleNamespace(t_gen=10.0),
    )
    return stream, SimpleNamespace(offset=SimpleNamespace(latency=latency, known=known))


@pytest.mark.parametrize(
    ("changes", "until"),
    [
        ({}, 10.3),
        ({"period": 0.2}, 10.18),
        ({"period": 0.05}, 10.12),
        ({"markovian": False}, 10.12),
        ({"latency": 0.5}, -math.inf),
        ({"known": False}, -math.inf),
    ],
)
def test_how_long_a_sample_waits(changes, until):
    """Until there is an answer, and of a Markovian stream a little longer while no newer one is near."""
    stream, leader = waiting(**changes)
    assert waits_until(stream, 10.0, leader) == pytest.approx(until)


@pytest.mark.parametrize(
    ("now", "changes", "use"),
    [
        (10.1, {}, True),
        (10.29, {}, False),
        (10.2, {"latency": 0.5}, True),
        (10.3, {"latency": 0.5}, False),
        (10.2, {"latency": 0.5, "period": 3.0}, False),
    ],
)
def test_what_is_lent_for_a_sample_that_is_there_is_of_use(now, changes, use):
    """While it waits, or where the next one comes soon enough."""
    assert serves(now, *waiting(**changes)) is use
