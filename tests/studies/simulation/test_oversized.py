"""Samples larger than a window beside small ones, in a team that shares the limit."""

import pytest

from planner import Constraint, Linear, Message, Problem, SearchSettings, Stream
from planner.constraints import violations
from studies.simulation.medium import Medium
from studies.simulation.missions import specs_of
from studies.simulation.team import Frame, Team

LIMIT, WINDOW = 50_000.0, 0.5
LATENCY = 0.02
SECONDS = 6.0
SPEC = """
[[constraint]]
kind = "throughput"
limit = "800 kbit/s"
window = 0.5
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
aggregation = "most_recent"
weight = 1.0
utility = {{ kind = "video" }}
[[information_type]]
name = "map"
keys = ["robot/*/map"]
aggregation = "most_recent"
weight = {weight}
utility = {{ kind = "exponential", tau = 2.0 }}
"""


def flown(weight):
    """Three robots publish 2 kB ten times a second, and one of them 60 kB twice; an operator wants everything."""
    frames = [
        Frame(f"r{r}", f"robot/r{r}/camera", 2.0 + 0.03 * r + k / 10, 2_000, {})
        for r in (1, 2, 3)
        for k in range(int(10 * SECONDS))
    ]
    frames += [Frame("r1", "robot/r1/map", 2.01 + k / 2, 60_000, {}) for k in range(int(2 * SECONDS))]
    frames.sort(key=lambda frame: frame.t_gen)
    interests = {"r1": (), "r2": (), "r3": (), "op": ("robot/**",)}
    search = SearchSettings(search="best")
    team = Team(specs_of(SPEC.format(weight=weight)), interests, Medium(1e7, delay=LATENCY), search=search)
    return team.run(frames, 2.0 + SECONDS)


@pytest.mark.full
@pytest.mark.parametrize(("weight", "least"), [(0.1, 0), (100.0, 1)])
def test_a_large_sample_is_sent_when_it_is_worth_what_it_displaces(weight, least):
    """Small ones go beside it as far as all keeps the limit on average; else they are sent alone."""
    deliveries = flown(weight)
    large = [d for d in deliveries if d.frame.key.endswith("map") and d.t_sent > 3.0]
    assert len(large) >= least
    assert len(large) == 0 or weight > 1.0
    assert not _overfull(large)
    assert not _overfull([d for d in deliveries if d not in large and d.t_sent > 3.0])
    sent = sum(d.frame.size for d in deliveries if d.t_sent > 3.0)
    assert sent <= LIMIT / WINDOW * (SECONDS - 1.0) + 60_000


def _overfull(deliveries):
    """The windows of the limit in which too much was sent, by the definition."""
    sent = tuple(
        Message(0, d.t_sent, d.t_sent, d.t_sent, Linear(1.0, 1.0), 1.0, (float(d.frame.size),))
        for d in sorted(deliveries, key=lambda d: d.t_sent)
    )
    limit = Constraint("throughput", WINDOW, LIMIT)
    return violations(Problem((Stream(0),), sent, 0, (limit,), (), 0.0, 100.0), range(len(sent)))
