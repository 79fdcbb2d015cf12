"""Whole daemons that part and meet again, on real sessions over loopback."""

import pytest

from tests.proxy.counting import Counting
from tests.proxy.nodes import Heard
from tests.proxy.test_daemon import SPECS, Robot
from tests.waiting import wait_until
from utility_specs import load_specs


@pytest.fixture
def specs(tmp_path):
    path = tmp_path / "specs.toml"
    path.write_text(SPECS)
    return load_specs(path)


def streams(robot):
    """What a robot knows of streams: whose, which, and how many were generated."""
    return {(s["robot"], s["key"]): s["generated"] for s in robot.status()["streams"]}


def peers(robot):
    return [peer["robot"] for peer in robot.status()["peers"]]


def test_clones_that_meet_later_part_and_meet_again(stack, specs, caplog):
    """Each says that there are two, both know each other's streams, and after a partition again."""
    first = Robot(stack, "r1", specs)
    relay = stack.enter_context(Counting(first.mesh, cut=True))
    second = Robot(stack, "r1", specs, (relay.endpoint,))
    assert first.daemon.robot == second.daemon.robot == "r1"
    shown = {id(robot): f"r1-{zid[:4]}" for robot, zid in ((first, zid_of(second)), (second, zid_of(first)))}
    robots = (first, second)
    listeners = [Heard(robot.node(), "covered/**") for robot in robots]
    apps = [robot.node() for robot in robots]

    def publish():
        for number, app in enumerate(apps):
            app.put(f"covered/{number}", b"x")

    relay.mend()
    for robot in robots:
        wait_until(lambda robot=robot: peers(robot) == [shown[id(robot)]], what="the other")
        assert any("are called 'r1'" in warning for warning in robot.status()["warnings"])
    assert caplog.text.count("two robots on the mesh are called 'r1'") == 2
    wait_until(lambda: publish() or all(len(streams(robot)) == 2 for robot in robots), what="both streams at both")
    wait_until(lambda: publish() or all(heard.samples for heard in listeners), what="samples both ways")

    relay.cut()
    for robot in robots:
        wait_until(lambda robot=robot: not peers(robot), what="the end of the other")
        assert len(streams(robot)) == 1
        assert robot.status()["warnings"] == []
    publish()
    relay.mend()
    for number, robot in enumerate(robots):
        mine, other = (f"covered/{number}", f"covered/{1 - number}")
        publisher = robots[1 - number]
        wait_until(
            lambda robot=robot, mine=mine, other=other: (
                set(streams(robot)) == {("r1", mine), (shown[id(robot)], other)}
            ),
            what="the same streams as before",
        )
        wait_until(
            lambda robot=robot, other=other, publisher=publisher: (
                streams(robot)[(shown[id(robot)], other)] == streams(publisher)[("r1", other)]
            ),
            what="what was published meanwhile",
        )
        assert robot.status()["counts"]["conserved"]


def zid_of(robot):
    """The mesh session of a robot."""
    return robot.status()["daemon"]["sessions"]["mesh"]
