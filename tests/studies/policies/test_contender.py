"""Contenders make their policies afresh."""

from studies.policies import Contender, RandomSends
from studies.workload import MIXED, mission


def test_every_flight_has_a_policy_of_its_own():
    """A second flight of a mission repeats the first, although the policy draws numbers."""
    contender = Contender("random", lambda _: RandomSends(0.5, seed=3))
    flown = mission(MIXED, seed=0, seconds=5.0)
    (first, one), (second, other) = (contender.fly(flown, 10) for _ in range(2))
    assert first == second
    assert one is not other
