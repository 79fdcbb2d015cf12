"""The page's parts together, with daemons, a demo and a daemon that goes."""

import asyncio
import json
import struct
import threading
from functools import partial

import pytest
import zenoh

from proxy.bridge import keys
from proxy.bridge.fleet import CROSSED
from proxy.commands.client import NoAnswerError, connected
from proxy.page import demo
from proxy.page.page import Page
from tests.daemons import Running
from tests.pages import SPECS, Fleet, World
from tests.proxy.nodes import closing, free_endpoint, plain_session
from tests.waiting import wait_until


class Watching:
    """Somebody who watches a page, without a browser: `heads` is what was told."""

    def __init__(self, page):
        self.heads = []
        self._page = page
        self._thread = threading.Thread(target=lambda: asyncio.run(self._watch()))
        self._thread.start()

    async def _watch(self):
        async for message in self._page.hub.join().messages():
            self.heads.append(json.loads(message[8 : 8 + struct.unpack(">I", message[:4])[0]]))

    def end(self):
        self._page.hub.close()
        self._thread.join()

    def until(self, fits, what):
        wait_until(lambda: any(fits(head) for head in list(self.heads)[-20:]), what=what)


@pytest.fixture
def watch(stack):
    """Open a page in this process and watch it."""

    def open_page(*endpoints, robot=None, keys=()):
        page = Page(endpoints, robot, keys, 0.1)
        page.start()
        stack.callback(page.stop)
        watching = Watching(page)
        stack.callback(watching.end)
        return page, watching

    return open_page


@pytest.mark.full
def test_a_demo_offers_its_world_while_it_is_there(stack, watch, tmp_path):
    """The channel is set, and something red comes into a path; what the demo refuses is said."""
    fleet = Fleet(tmp_path, stack, robots=1, obey=False)
    page, watching = watch(fleet.ground.endpoint, fleet.robots[0].endpoint)
    watching.until(lambda head: head["kind"] == "frame", "an image")
    watching.until(
        lambda head: head["kind"] == "status" and head["by"] == "ground" and head["demo"] is None, "a status"
    )
    world = World(fleet.ground.endpoint, ["r1"])
    stack.callback(world.close)
    offered = {"channel": {"limit": 750_000.0, "latency": 0.0, "loss": 0.0}, "red": {"robots": ["r1"]}}
    watching.until(lambda head: head.get("demo") == offered, "the demo")
    assert json.loads(page.orders.channel(b'{"limit": 5e5, "latency": 0.1, "loss": 0}'))["limit"] == 5e5
    assert world.channel == demo.Channel(5e5, 0.1, 0.0)
    page.orders.red(b'{"robot": "r1"}')
    assert world.reds == ["r1"]
    world.end()
    watching.until(lambda head: head["kind"] == "status" and head["demo"] is None, "the end of the demo")
    with pytest.raises(NoAnswerError, match="nobody answers at"):
        page.orders.channel(b'{"limit": 5e5, "latency": 0.1, "loss": 0}')


@pytest.mark.full
def test_robots_that_obey_no_order_for_all_are_switched_where_they_answer(stack, watch, tmp_path):
    """Modes, that is; specs they do not take from afar, and then nobody is switched."""
    fleet = Fleet(tmp_path, stack, robots=2, obey=False)
    page, watching = watch(fleet.ground.endpoint, fleet.robots[0].endpoint)
    watching.until(lambda _: len(page._asking.places()) == 2, "both to answer")
    outcomes = {each.robot: each for each in page.orders.filter("shadow")}
    assert [outcomes[name].obeyed for name in ("ground", "r1", "r2")] == [True, True, False]
    assert [daemon.status()["mode"] for daemon in (fleet.ground, *fleet.robots)] == ["shadow", "shadow", "enforce"]
    assert not any(each.obeyed for each in page.orders.filter("paper"))
    assert fleet.robots[0].status()["mode"] == "shadow"
    page.orders._places = lambda: {"r2": "tcp/127.0.0.1:1"}
    (of_r2,) = [each for each in page.orders.filter("off") if each.robot == "r2"]
    assert not of_r2.obeyed
    assert of_r2.said[1:] == ("no daemon answers at tcp/127.0.0.1:1; is `sendworthy run` running?",)


@pytest.mark.full
def test_a_robot_that_obeys_another_operator_is_not_switched(stack, watch, tmp_path):
    """Both operators hear that not all obeyed; here while the order of the other one waits for a robot that hangs."""
    fleet = Fleet(tmp_path, stack, robots=2)
    page, watching = watch(fleet.ground.endpoint, fleet.robots[0].endpoint)
    watching.until(lambda _: len(page._asking.places()) == 2, "both to answer")

    def order_pass():
        with connected(fleet.robots[0].endpoint) as other:
            other.order("r1", "mode", b"pass")

    with fleet.robots[1].paused():
        other = threading.Thread(target=order_pass)
        other.start()
        wait_until(lambda: fleet.ground.status()["mode"] == "pass", what="the order of the other operator")
        outcomes = {each.robot: each for each in page.orders.filter("shadow")}
        other.join()
    assert outcomes["ground"].obeyed
    assert (outcomes["r1"].obeyed, outcomes["r1"].said) == (False, (CROSSED,))
    assert fleet.robots[0].status()["mode"] == "pass"


@pytest.mark.full
def test_a_daemon_that_comes_later_or_again_is_found(stack, watch, tmp_path):
    """The page says that there is none, and goes on when there is one."""
    place = tmp_path / "specs.d"
    place.mkdir()
    (place / "camera.toml").write_text(SPECS.format(limit="1 Mbit/s"))
    first = Running("--robot", "ground", "--specs.path", str(place))
    stack.callback(first.end)
    first.wait_for("sendworthy ")
    page, watching = watch(first.endpoint)
    watching.until(lambda head: head.get("specs"), "the specs")
    first.end()
    watching.until(lambda head: "no daemon answers" in head.get("away", ""), "its end")
    (place / "camera.toml").write_text(SPECS.format(limit="2 Mbit/s"))
    again = Running("--robot", "ground", "--specs.path", str(place), endpoint=first.endpoint)
    stack.callback(again.end)
    wait_until(lambda: "2 Mbit/s" in page.specs()["files"].get("camera.toml", ""), what="its new specs")
    watching.until(lambda head: head.get("robots") and not head["away"], "the daemon")


def test_what_strange_daemons_say_does_not_stop_the_page(stack, watch):
    """Where several answer it asks to choose; numbers that are none are not known, and what is no status is shown."""
    where = free_endpoint()
    router = closing(stack, plain_session("router", listen=(where,)))
    told = {"a": {"robot": "a", "zid": "1"}, "b": {"robot": "b", "zid": "2"}}

    def answer(name, query):
        with query:
            query.reply(keys.status(name), json.dumps(told[name]))

    for name in told:
        handler = zenoh.handlers.Callback(partial(answer, name), indirect=False)
        router.declare_queryable(keys.status(name), handler)
    _, watching = watch(where)
    watching.until(lambda head: "choose with --robot a|b" in head.get("away", ""), "the question which one")
    watching.end()
    _, watching = watch(where, robot="a")
    watching.until(lambda head: "of a version that cannot" in head.get("away", ""), "that it tells no specs")
    told["a"]["budget"] = 3
    watching.until(lambda head: "no daemon of this version" in head.get("away", ""), "that this is no status")
    shown = {"constraint": "air", "used_by_all": 1.0, "limit": None, "price_per_kb": None}
    told["a"]["budget"] = [shown | {"limit": float("inf"), "price_per_kb": float("nan")}]
    watching.until(lambda head: head.get("limits"), "the limit")
    (limit,) = next(head["limits"] for head in reversed(watching.heads) if head.get("limits"))
    assert {name: limit[name] for name in shown} == shown
