"""Missions of real traffic."""

from collections import Counter
from itertools import pairwise

import pytest

from studies.simulation.missions import OPERATOR, SIZE
from studies.simulation.traffic.missions import ALONE, alone, draw


def test_a_seed_draws_one_mission():
    """The same traffic at every latency and for every audience; another seed draws another one."""
    one, late = (draw("mixed", 2, 3, 10.0, latency=latency) for latency in (0.02, 0.5))
    assert one.frames == late.frames == draw("mixed", 2, 3, 10.0, latency=0.02, everybody=True).frames
    assert one.frames != draw("mixed", 2, 4, 10.0, latency=0.02).frames
    message, later = one.problem.messages[5], late.problem.messages[5]
    assert later.t_rcv - message.t_rcv == pytest.approx(0.48)


@pytest.mark.parametrize("name", ["mixed", "random", "cameras", "crowd", "uniform-few"])
def test_messages_are_the_frames(name):
    """In order, with the worth that the specs say."""
    mission = draw(name, 3, 0, 20.0, latency=0.02)
    assert mission.frames
    times = [frame.t_gen for frame in mission.frames]
    assert times == sorted(times)
    assert times[-1] < mission.problem.t_end == 20.0
    for message, frame in zip(mission.problem.messages, mission.frames, strict=True):
        kind = mission.specs.match(frame.key)
        assert message.t_gen == frame.t_gen
        assert message.t_rcv == pytest.approx(frame.t_gen + 0.02)
        assert message.scale == pytest.approx(kind.scale(frame.features))
        assert mission.problem.streams[message.stream].robot == int(frame.robot[1:])


def test_mixed_is_what_the_model_says():
    """Images at 10 Hz beside small samples; each of those is known, and of alarms too."""
    mission = draw("mixed", 4, 0, 40.0, latency=0.02)
    counts = Counter(frame.key for frame in mission.frames)
    assert counts["r2/camera"] == pytest.approx(395, abs=6)
    assert counts["r2/odometry"] == pytest.approx(790, abs=11)
    small = {mission.frames[i].key.split("/")[1] for i in mission.small}
    assert small == {"odometry", "telemetry", "log", "alarm"}
    assert mission.alarms == {i for i, frame in enumerate(mission.frames) if frame.key.endswith("alarm")}
    assert 8 <= len(mission.alarms) <= 35
    assert max(mission.frames[i].size for i in mission.small) <= 400
    images = [frame.size for frame in mission.frames if frame.key.endswith("camera")]
    assert len(set(images)) > 1000


def test_one_robot_at_a_time_sees_red():
    """For some seconds, then nobody does."""
    mission = draw("cameras", 4, 1, 40.0, latency=0.02)
    seen = [(frame.t_gen, frame.robot) for frame in mission.frames if frame.features["red"] > 0.0]
    assert 0.2 * len(mission.frames) / 4 < len(seen) < 0.8 * len(mission.frames) / 4
    for (t, robot), (after, other) in pairwise(seen):
        assert robot == other or after - t > 1.0


def test_an_operator_wants_everything_and_others_where_they_hear_it():
    """In unicast nobody else does."""
    unicast = draw("mixed", 2, 0, 2.0, latency=0.02).interests
    assert unicast == {"r0": (), "r1": (), OPERATOR: ("**",)}
    assert set(draw("uniform-most", 2, 0, 2.0, latency=0.02, everybody=True).interests.values()) == {("**",)}


def test_one_robot_can_publish_all():
    """The same frames under the same keys; of equal ones it has what messages have."""
    mission = draw("uniform-mixed", 10, 0, 10.0, latency=0.02)
    by_one = alone(mission)
    assert {frame.robot for frame in by_one.frames} == {ALONE}
    assert [frame.key for frame in by_one.frames] == [frame.key for frame in mission.frames]
    limits = [specs.constraints[0].measure.limit for specs in (mission.specs, by_one.specs)]
    assert limits == pytest.approx([mission.limit, mission.carried])
    assert mission.carried == 5.25 * SIZE < mission.limit
    assert mission.allowed == 100.0 * 11


def test_unknown_workloads_are_refused():
    """By their names."""
    with pytest.raises(KeyError):
        draw("none", 2, 0, 2.0, latency=0.02)
