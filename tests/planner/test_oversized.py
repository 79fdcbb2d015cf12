"""Messages larger than a window beside small ones: sent when they are worth more than what they displace."""

import pytest

from planner import Constraint, Exponential, Message, Problem, SearchSettings, Stream, Traffic, Video, start
from planner.constraints import violations

LARGE, SMALL, EVERY = 60_000.0, 2_000.0, 0.03


def beside_small_ones(weight):
    """Three streams of small messages that just had the channel, and one of large ones; 50 kB fit into a window."""
    small = [
        Message(k % 3, EVERY * k, EVERY * k, EVERY * k + 0.02, Video(), 1.0, (SMALL,)) for k in range(int(1.9 / EVERY))
    ]
    large = [Message(3, t, t, t + 0.02, Exponential(1.0, 2.0), weight, (LARGE,)) for t in (0.017, 0.517, 1.017, 1.517)]
    return Problem(
        streams=tuple(Stream(robot) for robot in range(4)),
        messages=tuple(sorted((*small, *large), key=lambda m: (m.t_gen, m.stream))),
        current=0,
        constraints=(Constraint("throughput", 0.5, 50_000.0),),
        traffic=tuple(Traffic(-EVERY * k, (SMALL,)) for k in range(1, 16)),
        t_start=-10.0,
        t_end=2.0,
    )


@pytest.mark.parametrize(("weight", "times"), [(0.1, []), (20.0, [1.017]), (100.0, [1.017])])
def test_a_valuable_one_is_sent_as_soon_as_the_channel_can_be_empty(weight, times):
    """Not postponed to the end of the window, for which small ones are always sent first."""
    problem = beside_small_ones(weight)
    search = start(problem, SearchSettings(search="best"), seed=1)
    search.run(300)
    plan = search.plan()
    assert [problem.messages[place].t_gen for place in plan.sends if problem.messages[place].stream == 3] == times
    assert not violations(problem, plan.sends)
    assert len(plan.prices) == 1
