"""The page's own place on the mesh: what anybody may answer there."""

import tempfile
from contextlib import ExitStack

import pytest
import zenoh

from proxy.page import demo
from proxy.page.watch import Watch
from tests.daemons import Running, specs_file
from tests.pages import World
from tests.proxy.nodes import plain_session
from tests.waiting import wait_until


@pytest.fixture(scope="module")
def daemon():
    with ExitStack() as closing:
        running = Running("--robot", "ground")
        closing.callback(running.end)
        running.wait_for("sendworthy ")
        yield running


@pytest.mark.parametrize(
    "answer", [100_000 * "[", 300 * "[" + 300 * "]", '{"limit": "x", "robots": 5}', '{"limit": 1}']
)
def test_what_is_no_demo_offers_nothing_and_ends_nothing(daemon, answer):
    """A demo that comes after it is seen, so the page still looks."""
    watch = Watch(daemon.endpoint, None, (), lambda _: None)
    stranger = plain_session("client", connect=(daemon.endpoint,))
    asked = []

    def serve(query):
        asked.append(query)
        with query:
            query.reply(query.key_expr, answer)

    stranger.declare_queryable(demo.ALL, zenoh.handlers.Callback(serve, indirect=False))
    watch.start()
    try:
        wait_until(lambda: len(asked) > 3, what="the second time that the page asks for a demo")
        assert watch.demo is None
        stranger.close()
        world = World(daemon.endpoint, ["r1"])
        try:
            offered = {"channel": {"limit": 750_000.0, "latency": 0.0, "loss": 0.0}, "red": {"robots": ["r1"]}}
            wait_until(lambda: watch.demo == offered, what="the demo")
        finally:
            world.close()
    finally:
        watch.stop()


@pytest.mark.full
def test_specs_that_cannot_be_read_for_a_while_end_nothing(tmp_path, monkeypatch):
    """As where /tmp is full: the page says so and still looks, and reads them as soon as it can."""
    with ExitStack() as closing:
        daemon = Running("--robot", "ground", "--specs.path", str(specs_file(tmp_path)))
        closing.callback(daemon.end)
        daemon.wait_for("sendworthy ")
        monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "missing"))
        watch = Watch(daemon.endpoint, None, (), lambda _: None)
        watch.start()
        closing.callback(watch.stop)
        wait_until(lambda: watch.in_force.problem, what="the problem")
        assert watch.in_force.problem == "specs cannot be looked at here: No such file or directory"
        assert not watch.in_force.specs.types
        (tmp_path / "missing").mkdir()
        wait_until(lambda: watch.in_force.specs.types, what="the specs")
        assert not watch.in_force.problem
