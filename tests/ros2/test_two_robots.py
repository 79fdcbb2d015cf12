"""Two robots with nodes of ROS 2: behind Sendworthy as behind the routers that `rmw_zenohd` runs."""

import json

import pytest

from proxy import clock
from proxy.bridge import keys
from proxy.config import AppConfig, BridgeConfig, Config, MeshConfig, PlannerConfig
from proxy.core.model.mode import Mode
from proxy.daemon import Daemon
from tests.proxy.nodes import answers, closing, free_endpoint, plain_session
from tests.ros2.node import Node
from tests.waiting import wait_until
from utility_specs import load_specs

SPECS = """
[[constraint]]
kind = "throughput"
limit = "80 kbit/s"
window = 0.5
[[information_type]]
name = "camera"
keys = ["*/**/camera/image_raw/*/*", "*/**/cmd_vel/*/*"]
utility = { kind = "video" }
"""


class Site:
    """A robot: where its nodes connect, and the nodes."""

    def __init__(self, stack, endpoint, name=None):
        self._stack = stack
        self._endpoint = endpoint
        self._name = name
        self._operator = name and closing(stack, plain_session("client", connect=(endpoint,)))

    def node(self, name):
        node = Node(name, router=self._endpoint)
        self._stack.callback(node.close)
        return node

    def status(self):
        (answer,) = answers(self._operator, keys.status(self._name))
        return json.loads(answer)

    def counts(self):
        return self.status()["counts"]["by_reason"]


@pytest.fixture
def behind_daemons(stack, tmp_path):
    """Two robots behind daemons that are linked."""
    path = tmp_path / "specs.toml"
    path.write_text(SPECS)

    def start(mode, **bridge):
        apps, mesh = [free_endpoint(), free_endpoint()], [free_endpoint(), free_endpoint()]
        sites = []
        for i in range(2):
            config = Config(
                robot=f"r{i}",
                mode=mode,
                app=AppConfig(listen=(apps[i],)),
                mesh=MeshConfig(listen=(mesh[i],), connect=tuple(mesh[:i]), scouting=False),
                bridge=BridgeConfig.model_validate(bridge),
                planner=PlannerConfig(iterations=50),
            )
            daemon = Daemon(config, load_specs(path))
            daemon.start()
            stack.callback(daemon.stop)
            sites.append(Site(stack, apps[i], config.robot))
        wait_until(lambda: all(site.status()["peers"] for site in sites), what="the robots to meet")
        return sites

    return start


def behind_routers(stack):
    """Two robots behind routers that are linked."""
    first, second = free_endpoint(), free_endpoint()
    closing(stack, plain_session("router", listen=(first,), stamps=True))
    router = closing(stack, plain_session("router", listen=(second,), connect=(first,), stamps=True))
    wait_until(router.info.routers_zid, what="the routers to be linked")
    return [Site(stack, first), Site(stack, second)]


@pytest.fixture(params=["routers", "pass", "enforce", "profile"])
def sites(request, stack, behind_daemons):
    """Two robots, behind whatever."""
    if request.param == "routers":
        return behind_routers(stack)
    if request.param == "profile":
        return behind_daemons(Mode.ENFORCE, profile="ros2")
    return behind_daemons(Mode(request.param))


def test_nodes_see_each_other_and_who_leaves_is_gone(sites):
    """All entities of a node are in the graph of a node on the other robot, until it ends."""
    here, there = sites[0].node("here"), sites[1].node("there")
    here.advertise("/chatter")
    here.subscribe("/r1/other")
    here.serve("/add")
    here.client("/sub")
    expected = {("NN", "here", ""), ("MP", "here", "/chatter"), ("MS", "here", "/r1/other")}
    expected |= {("SS", "here", "/add"), ("SC", "here", "/sub")}
    wait_until(lambda: there.graph() == expected, what="the graph there")
    wait_until(lambda: here.graph() == {("NN", "there", "")}, what="the graph here")
    here.close()
    wait_until(lambda: not there.graph(), what="the end of the node there")


def test_listeners_hear_a_talker_with_its_attachments(sites):
    """On both robots each message once, in order, with payload and attachment byte for byte."""
    talker = sites[0].node("talker")
    talker.advertise("/chatter")
    listeners = [site.node(f"listener{i}") for i, site in enumerate((*sites, sites[1]))]
    for listener in listeners:
        listener.subscribe("/chatter")
    sent = []

    def all_hear():
        sent.append((b"%d" % len(sent), talker.publish("/chatter", b"%d" % len(sent))))
        return all(listener.heard["/chatter"] for listener in listeners)

    wait_until(all_hear, what="all to hear the talker")
    for _ in range(50):
        payload = bytes(range(256)) + b"%d" % len(sent)
        sent.append((payload, talker.publish("/chatter", payload)))
    for listener in listeners:
        wait_until(lambda listener=listener: sent[-1] in listener.heard["/chatter"], what="the last message")
        heard = listener.heard["/chatter"]
        assert heard == sent[-len(heard) :]
    assert all(len(attachment) == 33 for _, attachment in sent)


def test_a_service_is_called_from_the_other_robot(sites):
    """One answer, to this request, by the one server."""
    server, caller = sites[0].node("server"), sites[1].node("caller")
    server.serve("/reverse")
    call = caller.client("/reverse")
    wait_until(lambda: ("SS", "server", "/reverse") in caller.graph(), what="the server in the graph")
    wait_until(lambda: call(b"hello") == [(b"olleh", True)], what="the service")
    assert [call(b"%d!" % i) for i in range(5)] == [[(b"!%d" % i, True)] for i in range(5)]


def test_a_late_joiner_gets_what_is_latched_once(sites):
    """The last message of a transient local topic, and then each new one; on the same robot too."""
    latching = sites[0].node("latching")
    latching.advertise("/tf_static", latched=True)
    latching.publish("/tf_static", b"old")
    latching.publish("/tf_static", b"latched")
    late = [site.node(f"late{i}") for i, site in enumerate(sites)]
    for node in late:
        node.subscribe("/tf_static", latched=True)
        wait_until(lambda node=node: node.heard["/tf_static"], what="what is latched")
        wait_until(lambda node=node: ("MP", "latching", "/tf_static") in node.graph(), what="the publisher")
    wait_until(lambda: len([e for e in latching.graph() if e[0] == "MS"]) == 2, what="both subscriptions")
    latching.publish("/tf_static", b"new")
    for node in late:
        wait_until(lambda node=node: len(node.heard["/tf_static"]) > 1, what="what is new")
    latching.publish("/tf_static", b"last")
    for node in late:
        wait_until(lambda node=node: len(node.heard["/tf_static"]) > 2, what="what is last")
        assert [payload for payload, _ in node.heard["/tf_static"]] == [b"latched", b"new", b"last"]


def test_a_late_publisher_is_heard_too(sites):
    """Who subscribes first gets what is published before the robots know of the subscription."""
    waiting, latching = sites[1].node("waiting"), sites[0].node("latching")
    waiting.subscribe("/map", latched=True)
    latching.advertise("/map", latched=True)
    latching.publish("/map", b"map")
    wait_until(lambda: waiting.heard["/map"], what="the map")
    wait_until(lambda: ("MS", "waiting", "/map") in latching.graph(), what="the subscription")
    latching.publish("/map", b"next")
    wait_until(lambda: waiting.heard["/map"][-1][0] == b"next", what="the next one")
    assert [payload for payload, _ in waiting.heard["/map"]] == [b"map", b"next"]


def test_the_profile_keeps_home_what_belongs_there(behind_daemons):
    """The log is heard on its own robot and on no other, and no other sees who publishes it."""
    sites = behind_daemons(Mode.PASS, profile="ros2")
    talker, home, away = sites[0].node("talker"), sites[0].node("home"), sites[1].node("away")
    for node in (home, away):
        node.subscribe("/rosout")
        node.subscribe("/chatter")
    for topic in ("/rosout", "/chatter"):
        talker.advertise(topic)

    def both_hear():
        talker.publish("/rosout", b"log")
        talker.publish("/chatter", b"hello")
        return home.heard["/rosout"] and away.heard["/chatter"]

    wait_until(both_hear, what="the log here and the talk there")
    assert not away.heard["/rosout"]
    wait_until(lambda: ("MP", "talker", "/chatter") in away.graph(), what="the publisher there")
    assert ("MP", "talker", "/rosout") in home.graph()
    assert ("MP", "talker", "/rosout") not in away.graph()
    assert ("MS", "away", "/rosout") not in talker.graph()


def test_commands_bypass_a_channel_that_is_used_up(behind_daemons):
    """The camera's frames are thinned, every command arrives, though a spec covers both."""
    sites = behind_daemons(Mode.ENFORCE, profile="ros2")
    robot, viewer = sites[0].node("robot"), sites[1].node("viewer")
    for topic in ("/camera/image_raw", "/cmd_vel"):
        robot.advertise(topic)
        viewer.subscribe(topic)
    frame = bytes(2000)

    def both_cross():
        robot.publish("/camera/image_raw", frame)
        robot.publish("/cmd_vel", b"0")
        return viewer.heard["/camera/image_raw"] and viewer.heard["/cmd_vel"]

    started = clock.monotonic()
    wait_until(both_cross, what="both topics to cross")
    for i in range(1, 51):
        for _ in range(5):
            robot.publish("/camera/image_raw", frame)
        robot.publish("/cmd_vel", b"%d" % i)
        # All at once would not fit into the queue of the node's own session, which then drops the last ones.
        wait_until(lambda i=i: viewer.heard["/cmd_vel"][-1][0] == b"%d" % i, what="the command")
    assert [payload for payload, _ in viewer.heard["/cmd_vel"]][-51:] == [b"%d" % i for i in range(51)]
    wait_until(
        lambda: sum(n for reason, n in sites[0].counts().items() if reason.startswith("dropped:")) > 25,
        what="frames to be dropped",
    )
    wait_until(lambda: sites[0].counts()["passed:bypass"] >= 51, what="the count of commands")
    # Two frames in any half a second, however long a busy machine took.
    assert len(viewer.heard["/camera/image_raw"]) <= 2 * (2 * (clock.monotonic() - started) + 2)
