"""Daemons in installations that have Zenoh routers already, on real sessions; routers are processes of their own."""

import itertools
import json

import pytest
import zenoh

from proxy.bridge import keys
from proxy.config import AppConfig, Config, MeshConfig
from proxy.core.model.mode import Mode
from proxy.daemon import Daemon
from tests.proxy.nodes import Heard, answers, closing, free_endpoint, free_group, outside, plain_session, scouting
from tests.routers import Router
from tests.waiting import wait_until
from utility_specs import Specs

QUICK = {"period_init_ms": 50, "period_max_ms": 50}


class Robot:
    """A daemon whose apps are at `routers`, or at the daemon itself when there are none."""

    def __init__(self, stack, name, *, routers=(), mesh=None, connect=(), group=None):
        self._stack = stack
        self.name = name
        self.mesh = free_endpoint()
        own = () if routers else (free_endpoint(),)
        self.at = routers[0] if routers else own[0]
        mesh = mesh or MeshConfig(listen=(self.mesh,), connect=connect, scouting=False)
        multicast = {"scouting": {"multicast": {"address": group}}} if group else {}
        app = AppConfig(listen=own, connect=routers, scouting=group is not None, zenoh=multicast)
        config = Config(robot=name, mode=Mode.PASS, app=app, mesh=mesh)
        self.daemon = Daemon(config, Specs.empty())
        self.daemon.start()
        stack.callback(self.daemon.stop)
        self.operator = node(stack, self.at)

    def app(self):
        return node(self._stack, self.at)

    def status(self):
        """What the daemon says, as soon as the operator reaches it: both come back after a restart of their router."""
        said = []
        wait_until(lambda: said.extend(answers(self.operator, keys.status(self.name))) or said, what="an answer")
        return json.loads(said[-1])

    def warnings(self):
        return " ".join(self.status()["warnings"])


def node(stack, endpoint):
    """A plain application at `endpoint`; it is back soon after a restart of what is there."""
    session = plain_session("client", connect=(endpoint,), retry=QUICK)
    return closing(stack, session)


def router(stack, *connect, endpoint=None):
    made = Router(endpoint or free_endpoint(), *connect)
    stack.callback(made.kill)
    return made


def met(*robots):
    names = {robot.name for robot in robots}
    for robot in robots:
        wait_until(
            lambda robot=robot: {peer["robot"] for peer in robot.status()["peers"]} == names - {robot.name},
            what=f"{robot.name} to meet the others",
        )


def crosses(speaker, listener, key):
    """Let samples cross until one arrives; then, of twenty more, each arrives once and in order."""
    heard = Heard(listener, key)
    wait_until(lambda: speaker.put(key, "first") or heard.payloads, what=f"a sample of {key}")
    for i in range(20):
        speaker.put(key, str(i), congestion_control=zenoh.CongestionControl.BLOCK)
    wait_until(lambda: heard.payloads[-1:] == ["19"], what=f"the last sample of {key}")
    assert [text for text in heard.payloads if text != "first"] == [str(i) for i in range(20)]
    heard.subscriber.undeclare()


def answers_once(asker, answerer, key):
    """A queryable is found, and answers a query once, then is gone."""

    def answer(query):
        with query:
            query.reply(key, "answer")

    queryable = answerer.declare_queryable(key, zenoh.handlers.Callback(answer, indirect=False))
    options = {"target": zenoh.QueryTarget.ALL, "consolidation": zenoh.ConsolidationMode.NONE}
    wait_until(lambda: list(answers(asker, key)), what=f"an answer of {key}")
    assert list(answers(asker, key, **options)) == ["answer"]
    queryable.undeclare()
    wait_until(lambda: not list(answers(asker, key)), what=f"the end of {key}")


def shows_token(watcher, holder, key):
    """A token is seen while it is there, and goes once."""
    seen = []
    handler = zenoh.handlers.Callback(lambda sample: seen.append(sample.kind), indirect=False)
    subscriber = watcher.liveliness().declare_subscriber(key, handler, history=True)
    token = holder.liveliness().declare_token(key)
    wait_until(lambda: list(watcher.liveliness().get(key, timeout=5.0)), what=f"the token {key}")
    token.undeclare()
    wait_until(lambda: not list(watcher.liveliness().get(key, timeout=5.0)), what=f"the end of the token {key}")
    wait_until(lambda: zenoh.SampleKind.DELETE in seen, what=f"news of the token {key}")
    # Zenoh may tell a token twice to who subscribes as it comes; one that came back would end twice.
    assert seen.count(zenoh.SampleKind.DELETE) == 1
    subscriber.undeclare()


def everything_crosses(one, other, name):
    """Samples, queries and tokens, both ways."""
    for number, (here, there) in enumerate(((one, other), (other, one))):
        key = f"{name}/{number}"
        crosses(here, there, f"{key}/samples")
        answers_once(here, there, f"{key}/query")
        shows_token(here, there, f"{key}/token")


@pytest.mark.full
def test_apps_stay_at_the_router_they_know_and_its_restart_heals(stack, caplog):
    """With `[app] connect` everything crosses once, both ways; after a restart of the router it does again."""
    caplog.set_level("INFO")
    known = router(stack)
    first = Robot(stack, "r1", routers=(known.endpoint,))
    second = Robot(stack, "r2", connect=(first.mesh,))
    met(first, second)
    app, other = first.app(), second.app()
    everything_crosses(app, other, "before")
    kept = Heard(app, "kept")
    wait_until(lambda: "kept" in first.status()["daemon"]["subscriptions"], what="the subscription")
    known.kill()
    wait_until(lambda: not first.daemon._bridge.describe()["subscriptions"], what="the end of what was behind it")
    wait_until(lambda: f"app.connect: no link to {known.endpoint} yet" in caplog.text, what="a word about it")
    known.start()
    wait_until(lambda: f"app.connect: {known.endpoint} is linked now" in caplog.text, what="the link")
    wait_until(lambda: other.put("kept", "after") or kept.payloads, what="a sample after the restart")
    everything_crosses(app, other, "after")
    assert first.status()["warnings"] == []


@pytest.mark.full
def test_routers_that_are_linked_around_the_daemons_double_nothing(stack):
    """Of two daemons whose apps are joined one bridges for both, and says so; a third robot hears all once.

    When the link between the routers is gone each bridges for its own apps again.
    """
    routers = [router(stack)]
    routers.append(router(stack, routers[0].endpoint))
    robots = []
    for name, at in (("r1", (routers[0].endpoint,)), ("r2", (routers[1].endpoint,)), ("r3", ())):
        robots.append(Robot(stack, name, routers=at, connect=tuple(robot.mesh for robot in robots)))
    met(*robots)
    wait_until(lambda: "robot r2 around the daemons" in robots[0].warnings(), what="the warning of r1")
    wait_until(lambda: "robot r1 around the daemons" in robots[1].warnings(), what="the warning of r2")
    assert sum(robot.daemon._neighbours.aside for robot in robots[:2]) == 1
    apps = [robot.app() for robot in robots]
    for i, j in ((0, 1), (1, 0), (0, 2), (2, 0), (1, 2), (2, 1)):
        crosses(apps[i], apps[j], f"joined/{i}{j}")
        answers_once(apps[i], apps[j], f"query/{i}{j}")
        shows_token(apps[i], apps[j], f"token/{i}{j}")
    routers[1].kill()
    routers[1] = router(stack, endpoint=routers[1].endpoint)
    wait_until(lambda: not robots[0].warnings() and not robots[1].warnings(), what="the end of the warnings")
    for i, j in ((0, 1), (1, 0), (1, 2)):
        everything_crosses(apps[i], apps[j], f"apart/{i}{j}")


def test_links_that_appear_under_traffic_start_no_storm(stack):
    """While routers are joined and parted under load nothing goes round: samples stay bounded, and end."""
    routers = [router(stack), router(stack)]
    robots = []
    for name, at in zip(("r1", "r2"), routers, strict=True):
        robots.append(Robot(stack, name, routers=(at.endpoint,), connect=tuple(robot.mesh for robot in robots)))
    met(*robots)
    stamping = closing(stack, plain_session("client", connect=(routers[0].endpoint,), stamps=True))
    apps, stamped = [robot.app() for robot in robots], [stamping]
    heard = [Heard(app, "load/**") for app in apps]
    wait_until(lambda: apps[0].put("load/x", "-") or heard[1].payloads, what="a first sample")
    joint = router(stack, *(each.endpoint for each in routers))
    said = 0

    def say():
        nonlocal said
        said += 1
        for app in (*apps, *stamped):
            app.put(f"load/{said}", str(said))
        return any(robot.daemon._neighbours.aside for robot in robots)

    wait_until(say, what="a daemon to stand aside")
    everything_crosses(*apps, "joined")
    rounds = itertools.count()

    def ended():
        counts = [len(each.samples) for each in heard]
        everything_crosses(*apps, f"still/{next(rounds)}")
        return [len(each.samples) for each in heard] == counts

    wait_until(ended, what="the end of what was said meanwhile")
    joint.kill()
    wait_until(lambda: not any(robot.daemon._neighbours.aside for robot in robots), what="both to bridge again")
    everything_crosses(*apps, "apart")


def test_apps_that_are_on_the_mesh_themselves_are_left_alone(stack):
    """A router that apps and mesh share: the daemon stands aside and says what is wrong."""
    shared = router(stack)
    mesh = MeshConfig(mode="client", connect=(shared.endpoint,))
    robot = Robot(stack, "r1", routers=(shared.endpoint,), mesh=mesh)
    wait_until(lambda: "link to the mesh around the daemon" in robot.warnings(), what="the warning")
    crosses(robot.app(), robot.app(), "shared")


def test_robots_meet_at_a_router(stack):
    """In mode "client" everything crosses between robots and with an operator's app at the router; a restart heals."""
    meeting = router(stack)
    mesh = MeshConfig(mode="client", connect=(meeting.endpoint,), zenoh={"connect": {"retry": QUICK}})
    robots = [Robot(stack, name, mesh=mesh) for name in ("r1", "r2")]
    met(*robots)
    apps = [*(robot.app() for robot in robots), node(stack, meeting.endpoint)]
    for i, j in ((0, 1), (0, 2), (1, 2)):
        everything_crosses(apps[i], apps[j], f"before/{i}{j}")
    assert [robot.status()["daemon"]["mesh"] for robot in robots] == [[], []]
    meeting.kill()
    wait_until(lambda: not any(robot.status()["peers"] for robot in robots), what="the robots to part")
    meeting.start()
    met(*robots)
    for i, j in ((0, 1), (0, 2), (1, 2)):
        everything_crosses(apps[i], apps[j], f"after/{i}{j}")


def test_a_sample_that_a_router_relays_costs_the_way_to_it_and_to_each_robot(stack):
    """An operator behind the router costs the uplink alone, each robot that listens one copy more."""
    meeting = router(stack)
    mesh = MeshConfig(mode="client", connect=(meeting.endpoint,))
    robots = [Robot(stack, name, mesh=mesh) for name in ("r1", "r2", "r3")]
    met(*robots)
    speaker, demand = robots[0].app(), robots[0].daemon._bridge.demand

    def cost():
        speaker.put("a", b"x")
        return demand.copies("a")

    def told(what):
        wanting = {robot.name: robot.daemon._bridge.describe()["subscriptions"] for robot in robots}
        return f"{what}: {cost()} copies, for {demand.wanting('a')}, of {wanting}:"

    operator = Heard(node(stack, meeting.endpoint), "a")
    wait_until(lambda: cost() == 1 and operator.samples, what=lambda: told("the operator"))
    listeners = [Heard(robot.app(), "a") for robot in robots[1:]]
    wait_until(lambda: cost() == 3, what=lambda: told("two robots"))
    operator.subscriber.undeclare()
    listeners[0].subscriber.undeclare()
    wait_until(lambda: cost() == 2, what=lambda: told("one robot"))


def test_an_application_that_scouts_finds_the_daemon_and_is_said_when_others_can_find_it(stack):
    """With `[app] scouting` one in the default configuration needs nothing; the status says that it is in the open."""
    group = free_group()
    first = Robot(stack, "r1", group=group)
    second = Robot(stack, "r2", connect=(first.mesh,))
    met(first, second)
    app = closing(stack, scouting(group, f"tcp/{outside()}:0"))
    wait_until(app.info.routers_zid, what="the daemon to be found")
    everything_crosses(app, second.app(), "scouted")
    said = f"peer {app.zid()} on this robot answers everybody"
    wait_until(lambda: first.daemon._lookout.look() or said in first.warnings(), what="the warning")
