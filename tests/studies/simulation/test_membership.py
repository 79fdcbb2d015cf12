"""Robots that come and go in a simulated team."""

import pytest

from proxy.core.gossip.tuning import TUNING
from proxy.core.protocol.messages import tag
from studies.simulation.churn import Crash, Join, Leave, Merge, Partition, Subscribe, joining
from studies.simulation.conditions import Conditions
from studies.simulation.flights import team
from studies.simulation.medium import Medium
from studies.simulation.membership import LEASE
from studies.simulation.missions import draw
from studies.simulation.team import Frame, Team
from studies.workload import MIXED
from utility_specs import load_specs


@pytest.fixture
def fly():
    """Fly three robots and an operator for so long under these happenings."""

    def fly(until, *happenings, **changes):
        how = Conditions(robots=3, seconds=4.0, iterations=50, happenings=happenings, **changes)
        flown = draw(MIXED, 0, how)
        flying = team(flown, how, 0)
        flying.run(flown.frames, until)
        return flying

    return fly


def known(flying, robot):
    """The names of the robots that one knows of."""
    return sorted(peer.robot for peer in flying.cores[robot].view.peers.values())


def test_all_know_each_other_and_what_they_want(fly):
    """Soon after the start everybody has everybody's state."""
    flying = fly(0.5)
    for robot, core in flying.cores.items():
        assert known(flying, robot) == sorted(set(flying.cores) - {robot})
        assert {peer.robot for peer in core.view.peers.values() if peer.state.subscriptions} <= {"op"}


def test_what_applications_subscribe_to_changes_in_flight(fly):
    """The others hear of it, and send nothing that nobody wants any more. Who is not there subscribes to nothing."""
    flying = fly(4.0, Subscribe(3.0, "op", ("r1/**",)), Subscribe(3.0, "absent", ("**",)))
    sent = {air.robot for air in flying.on_air if air.frame is not None and air.t >= 3.1}
    assert sent == {"r1"}
    assert {d.receiver for d in flying.deliveries if d.t_sent >= 3.1} == {"op"}


def test_what_robots_ask_each_other_goes_on_the_air(fly):
    """Questions for states, and what answers them."""
    flying = fly(3.5, Join(3.0, "r1"))
    asked = [air for air in flying.on_air if air.frame is None and air.size == TUNING.question and air.t >= 3.0]
    assert {air.robot for air in asked} >= {"r1"}
    answers = [air for air in flying.on_air if air.frame is None and not air.digest and air.t >= asked[0].t]
    assert len(answers) >= 2 * len(asked)


def test_a_crash_is_noticed_late_and_a_farewell_at_once(fly):
    """The token of a robot that fell silent is lost after the lease."""
    assert "r1" in known(fly(3.0 + 0.9 * LEASE, Crash(3.0, "r1")), "r0")
    assert "r1" not in known(fly(3.1 + LEASE, Crash(3.0, "r1")), "r0")
    left = fly(3.1, Leave(3.0, "r1"))
    assert "r1" not in known(left, "r0")
    assert "r1" not in left.cores


def test_who_comes_again_has_a_new_id(fly):
    """And sends again; the others know it and its streams."""
    flying = fly(12.0, Crash(3.0, "r1"), Join(7.0, "r1"))
    zid = flying.members["r1"].zid
    assert zid != "z-r1"
    assert tag(zid) in flying.cores["op"].view.peers
    assert any(stream.robot == "r1" for stream in flying.cores["op"].view.streams)
    assert flying.cores["r1"].counts.received > 0


def test_who_joins_late_is_not_there_before(fly):
    """Nobody knows it and it sends nothing, until it joins."""
    assert joining((Join(5.0, "r1"), Crash(3.0, "r2"), Join(6.0, "r2"))) == {"r1"}
    flying = fly(4.0, Join(5.0, "r1"))
    assert "r1" not in flying.cores
    assert "r1" not in known(flying, "op")
    assert "r1" in known(fly(6.0, Join(5.0, "r1")), "op")


def test_parts_of_a_mesh_lose_each_other_and_meet_again(fly):
    """Nothing crosses a partition; after the lease its sides miss each other, and after the merge they do not."""
    apart = Partition(3.0, (frozenset(("r0", "r1")), frozenset(("r2", "op"))))
    flying = fly(8.0, apart)
    assert known(flying, "r0") == ["r1"]
    assert known(flying, "op") == ["r2"]
    assert not [d for d in flying.deliveries if d.t_sent > 3.0 and d.frame.robot != "r2"]
    assert known(fly(9.0, apart, Merge(8.0)), "r0") == ["op", "r1", "r2"]


def test_a_partition_shorter_than_the_lease_goes_unnoticed(fly):
    """Tokens stay, and so do robots."""
    apart = Partition(3.0, (frozenset(("r0", "r1")), frozenset(("r2", "op"))))
    assert known(fly(8.0, apart, Merge(4.0)), "r0") == ["op", "r1", "r2"]


AMPLE = """
[[constraint]]
kind = "throughput"
limit = "2 Mbit/s"
window = 0.5
[[information_type]]
name = "position"
keys = ["position/*"]
aggregation = "most_recent"
utility = { kind = "linear", u0 = 1.0, slope = 0.5 }
"""


@pytest.mark.full
@pytest.mark.parametrize("back", ["r0", "r1", "r2"])
def test_who_comes_back_sends_within_a_second_though_the_others_go_on(tmp_path, back):
    """Nothing that is told to those who are there keeps it waiting, whether it led before or not."""
    (tmp_path / "specs.toml").write_text(AMPLE)
    robots = dict.fromkeys(("r0", "r1", "r2"), ("position/*",))
    happenings = (Leave(8.0, back), Join(8.6, back))
    flying = Team(load_specs(tmp_path), robots, Medium(3e6), iterations=50, happenings=happenings)
    frames = [
        Frame(robot, f"position/{robot}", 0.03 * n + 0.1 * k, 2000, {})
        for n, robot in enumerate(robots)
        for k in range(100)
    ]
    sent = flying.run(sorted(frames, key=lambda frame: frame.t_gen), 10.0)
    assert any(8.6 <= each.t_sent <= 9.6 for each in sent if each.frame.robot == back)
