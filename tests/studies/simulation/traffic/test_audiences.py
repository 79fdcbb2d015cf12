"""Who wants what in drawn teams."""

from itertools import pairwise

import numpy as np
import pytest

from planner import Linear
from proxy.core.view.subscribers import intersects
from studies.simulation.missions import OPERATOR
from studies.simulation.traffic.audiences import LARGEST, VIEWS, Audience, audiences, interests, offered
from studies.simulation.traffic.kinds import Kind
from studies.simulation.traffic.workloads import Workload

POSE, CAMERA = (Kind(name, Linear(1.0, 1.0), (1, 1), (size, size)) for name, size in (("pose", 100), ("camera", 2_000)))
TEAM = Workload("team", ((POSE, CAMERA), (POSE,), (POSE, CAMERA)), 10_000.0, 1.0)


def random(seed=7):
    return np.random.default_rng(seed)


def test_kinds_go_to_one_to_some_or_to_all_or_are_viewed():
    """What is too large for the limit in so many copies goes to the operator alone."""
    drawn = [audiences(random(seed), TEAM) for seed in range(200)]
    poses, cameras = ([each[name] for each in drawn] for name in ("pose", "camera"))
    assert {len(each.robots) for each in poses} == {0, 1, 2, 3}
    assert {len(each.robots) for each in cameras} == {0, 1, 2}
    assert CAMERA.sizes[0] * 3 <= LARGEST * TEAM.rate * TEAM.window < CAMERA.sizes[0] * 4
    assert 0 < sum(each.viewed for each in cameras) < 100
    assert {each.label for each in poses} == {"viewed", "for 1", "for 2", "for 3", "for 4"}


def test_what_is_offered_counts_the_copies_that_are_wanted():
    """Of what an operator looks at of one robot at a time that is one stream in the mean."""
    assert offered(TEAM, {"pose": Audience(), "camera": Audience()}) == pytest.approx(3 * 100 + 2 * 2_000)
    assert offered(TEAM, {"pose": Audience(("r0", "r1")), "camera": Audience(viewed=True)}) == pytest.approx(
        (2 + 2 + 3) * 100 + 2_000
    )


def test_nobody_subscribes_to_what_it_publishes_itself():
    """All others have what they want of each robot that has it."""
    of = {"pose": Audience(("r0", "r1", "r2")), "camera": Audience()}
    found = interests(random(), TEAM, of, 30.0)
    assert found.first == {
        OPERATOR: ("r0/pose", "r1/pose", "r2/pose", "r0/camera", "r2/camera"),
        "r0": ("r1/pose", "r2/pose"),
        "r1": ("r0/pose", "r2/pose"),
        "r2": ("r0/pose", "r1/pose"),
    }
    assert found.changes == ()


def test_the_operator_looks_at_one_robot_after_the_other():
    """It goes on with all the rest meanwhile."""
    of = {"pose": Audience(), "camera": Audience(viewed=True)}
    found = interests(random(), TEAM, of, 200.0)
    subscriptions = [found.first[OPERATOR], *(change.keys for change in found.changes)]
    assert all(set(keys) >= {"r0/pose", "r1/pose", "r2/pose"} for keys in subscriptions)
    assert all(sum(intersects("*/camera", key) for key in keys) == 1 for keys in subscriptions)
    assert all(before[-1] != after[-1] for before, after in pairwise(subscriptions))
    times = [0.0, *(change.t for change in found.changes), 200.0]
    assert all(VIEWS[0] <= apart <= VIEWS[1] for apart in np.diff(times[:-1]))
    assert times[-1] - times[-2] <= VIEWS[1]
