"""Teams of unequal robots."""

from collections import Counter

import numpy as np

from planner import Linear
from studies.simulation.traffic.kinds import Kind
from studies.simulation.traffic.unequal_teams import FACTOR, OWN, team

KINDS = (
    Kind("a", Linear(1.0, 1.0), (1.0, 2.0), (100.0, 200.0)),
    Kind("b", Linear(1.0, 1.0), (1.0, 2.0), (100.0, 200.0), anew=True),
)


def random(seed=7):
    return np.random.default_rng(seed)


def test_each_robot_has_kinds_of_its_own():
    """Half of them in the mean; some have all, and some none."""
    robots = [tuple(kind.name for kind in own) for own in team(random(), KINDS, 200)]
    counts = Counter(robots)
    assert set(counts) == {(), ("a",), ("b",), ("a", "b")}
    assert abs(sum(map(len, robots)) / (200 * len(KINDS)) - OWN) < 0.1


def test_the_streams_of_a_kind_differ_more_and_some_pause():
    """Rates and typical sizes do; sizes that are drawn anew differ already."""
    a, b = next(own for own in team(random(), KINDS, 20) if len(own) == 2)
    assert a.rates == b.rates == (1.0 / FACTOR, 2.0 * FACTOR)
    assert (a.sizes, b.sizes) == ((100.0 / FACTOR, 200.0 * FACTOR), (100.0, 200.0))
    assert 0.0 < a.pausing == b.pausing < 1.0


def test_somebody_has_something():
    """However few robots there are."""
    assert all(any(team(random(seed), KINDS[:1], 2)) for seed in range(50))
