"""ROS 2 on two hosts that share a channel: the daemons are all there is in place of `rmw_zenohd`."""

import pytest

from tests.system.robots import SENDWORTHY, wait_until_met
from tests.waiting import wait_until

pytestmark = pytest.mark.system

MODES = {
    "pass": ("--mode", "pass"),
    "enforce": ("--mode", "enforce"),
    "profile": ("--mode", "enforce", "--bridge.profile", "ros2"),
}


@pytest.fixture
def pair(start):
    """Start two robots and wait until they know each other."""

    def start_both(mode, **options):
        robots = [start(name, options=MODES[mode], **options) for name in ("a", "b")]
        for robot in robots:
            wait_until(robot.serves, what=f"start of {robot.name}")
        wait_until_met(robots)
        return robots

    return start_both


@pytest.mark.parametrize("mode", MODES)
def test_nodes_of_two_robots_work_together(pair, mode):
    """Graph, topic, service and latched topic, from one robot to the other, and the end of a node."""
    here, there = pair(mode)
    talker, neighbour, listener = here.node("talker"), here.node("neighbour"), there.node("listener")
    talker.do("advertise", "/chatter")
    talker.do("serve", "/reverse")
    talker.do("latch", "/tf_static")
    talker.ask("publish", "/tf_static", "frames")
    for node in (neighbour, listener):
        node.do("subscribe", "/chatter")
        node.do("subscribe_latched", "/tf_static")
    entities = {("NN", ""), ("MP", "/chatter"), ("SS", "/reverse"), ("MP", "/tf_static")}
    seen = {(kind, "talker", topic) for kind, topic in entities}
    for node in (neighbour, listener):
        wait_until(lambda node=node: seen <= node.graph(), what=f"the talker in the graph of {node.name}")
    assert_talk(talker, (neighbour, listener))
    assert_called(listener)
    assert_latched(talker, (neighbour, listener))
    talker.shut_down()
    for node in (neighbour, listener):
        wait_until(lambda node=node: not seen & node.graph(), what=f"the talker's end for {node.name}")


def assert_talk(talker, listeners):
    """Each message is heard once, in order, with its attachment byte for byte."""
    sent = []

    def all_hear():
        told = talker.ask("publish", "/chatter", str(len(sent)))
        sent.append([told["payload"], told["attachment"]])
        return all(node.heard("/chatter") for node in listeners)

    wait_until(all_hear, what="all to hear the talker")
    for node in listeners:
        wait_until(lambda node=node: sent[-1] in node.heard("/chatter"), what="the last message")
        heard = node.heard("/chatter")
        assert heard == sent[-len(heard) :]


def assert_called(caller):
    """A call has one answer."""
    answer = {"answers": [["olleh", True]]}
    wait_until(lambda: caller.ask("call", "/reverse", "hello") == answer, what="the service")


def assert_latched(talker, listeners):
    """Late joiners got what was latched, and each gets what is new, once."""
    talker.ask("publish", "/tf_static", "more frames")
    for node in listeners:
        wait_until(lambda node=node: len(node.heard("/tf_static")) > 1, what=f"frames for {node.name}")
        assert [payload for payload, _ in node.heard("/tf_static")] == ["frames", "more frames"]


def test_the_log_stays_home_and_commands_go_through_a_full_channel(pair):
    """With the profile: nothing of the log crosses, every command does while the camera takes all there is."""
    here, there = pair("profile", limit="200 kbit/s")
    robot, home, viewer = here.node("robot"), here.node("home"), there.node("viewer")
    for topic in ("/rosout", "/cmd_vel", "/camera/image_raw"):
        robot.do("advertise", topic)
        for node in (home, viewer):
            node.do("subscribe", topic)

    def known():
        robot.ask("publish", "/camera/image_raw", "first")
        robot.ask("publish", "/cmd_vel", "first")
        robot.ask("publish", "/rosout", "first")
        crossed = viewer.heard("/camera/image_raw") and viewer.heard("/cmd_vel")
        return crossed and home.heard("/rosout")

    wait_until(known, 20.0, "all to be heard where they may")
    frame = "x" * 4000
    for i in range(40):
        robot.do("publish", "/camera/image_raw", frame)
        robot.do("publish", "/cmd_vel", str(i))
        robot.do("publish", "/rosout", str(i))
        # One by one: of a burst a node's own session drops what a link does not take at once, on each as it may.
        for node, topic in ((viewer, "/cmd_vel"), (home, "/cmd_vel"), (home, "/rosout")):
            wait_until(lambda: node.heard(topic)[-1][0] == str(i), 20.0, f"{topic} {i}")  # noqa: B023 - called at once
    for node in (viewer, home):
        assert [p for p, _ in node.heard("/cmd_vel") if p != "first"] == [str(i) for i in range(40)]
    assert not viewer.heard("/rosout")
    assert ("MP", "robot", "/rosout") in home.graph()
    assert ("MP", "robot", "/rosout") not in viewer.graph()
    wait_until(lambda: not here.status()["counts"]["queued"], what="all to be decided")
    counts = here.status()["counts"]
    assert counts["conserved"]
    assert counts["by_reason"]["passed:bypass"] >= 40
    assert sum(n for reason, n in counts["by_reason"].items() if reason.startswith("dropped:")) >= 20


def test_localhost_may_mean_ipv6(start):
    """Both addresses of localhost are served."""
    robot = start("a")
    wait_until(robot.serves, what="the start")
    for endpoint in ("tcp/127.0.0.1:7447", "tcp/[::1]:7447"):
        asked = robot.host.run(*SENDWORTHY, "status", "--connect", endpoint)
        assert asked.returncode == 0, asked.stderr


def test_a_host_without_ipv6_starts_all_the_same(start):
    """The log says what is missing, and IPv4 works."""
    robot = start("a", ipv6=False)
    wait_until(robot.serves, what="the start")
    assert "no IPv6 on this host: applications connect to tcp/127.0.0.1:7447 only" in robot.log()
    assert robot.status()["robot"] == "a"
