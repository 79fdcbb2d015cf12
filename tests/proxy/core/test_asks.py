"""Who asks: robots whose next message nobody can foresee, where the answer is quick and asking affordable."""

from types import SimpleNamespace

import pytest

from planner.measures import Throughput
from proxy.core.asks import asks
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
