"""What the daemons tell each other, as each limit counts it."""

import pytest

from planner.measures import Energy, Messages, Throughput
from utility_specs import digests


@pytest.mark.parametrize(
    ("measure", "robots", "said"),
    [
        (Throughput(625.0, 0.5), 4, "64 % of it is for what the daemons of 4 robots tell each other, 100 B/s for each"),
        (Throughput(625.0, 0.5), 4, "leaves 112 B in 0.5 s to samples"),
        (Throughput(1000.0, 2.0), 3, "30 % of it"),
        (Throughput(5000.0, 2.0), 20, "leaves 6000 B in 2 s to samples"),
        (Messages(2, 1.0), 4, "90 % of it"),
        (Messages(2, 1.0), 4, "leaves 0.2 messages in 1 s to samples"),
        (Energy(1.0, 1.0, per_byte=4e-3), 9, "40 % of it"),
    ],
)
def test_a_limit_that_leaves_little_is_told_with_figures(measure, robots, said):
    """The same whatever the window is, unless the limit is one of so many messages."""
    assert said in digests.warning(measure, robots)


def test_a_limit_that_leaves_enough_is_left_alone():
    """The fewer robots there are the lower it may be."""
    assert digests.warning(Throughput(1600.0, 0.5), 4) == ""
    assert digests.warning(Throughput(1599.0, 0.5), 4) != ""
    assert digests.warning(Throughput(25.0, 0.5), 1) == ""
    assert digests.warning(Throughput(digests.least_limit(9), 0.5), 9) == ""
    assert digests.warning(Messages(10, 0.5), 4) == ""
