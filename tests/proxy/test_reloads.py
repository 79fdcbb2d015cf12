"""Many reloads while samples cross: nothing is lost, nothing arrives twice."""

import json
import os
import threading

import zenoh

from proxy.bridge import keys
from proxy.config import AppConfig, Config, MeshConfig, PlannerConfig, SpecsConfig
from proxy.daemon import Daemon
from proxy.reloading import read_specs
from tests.proxy.nodes import Heard, answers, closing, free_endpoint, plain_session
from tests.waiting import wait_until

RELOADS = int(os.environ.get("RELOADS", "150"))
"""The long run has a thousand."""
RATE = 200 if "RELOADS" in os.environ else 50
"""Samples per second; few enough that those of a second in which the machine stands still can wait."""
SPECS = """
[[constraint]]
kind = "throughput"
limit = "10 Mbit/s"
[[information_type]]
name = "NAME"
keys = ["KEY"]
weight = WEIGHT
aggregation = "sum"
utility = { kind = "step", lifetime = "10 s" }
"""
KINDS = (
    SPECS.replace("NAME", "one").replace("KEY", "covered/**").replace("WEIGHT", "1.0"),
    SPECS.replace("NAME", "two").replace("KEY", "**").replace("WEIGHT", "2.0"),
    SPECS.replace("NAME", "three").replace("KEY", "other/**").replace("WEIGHT", "3.0"),
)
"""The key of the samples is covered in one way, in another one, and not at all."""


class Publisher:
    """Publishes numbered samples at a steady rate until it is stopped."""

    def __init__(self, session):
        self.sent = 0
        self._session = session
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def stop(self):
        self._stop.set()
        self._thread.join()

    def _run(self):
        while not self._stop.wait(1.0 / RATE):
            self._session.put("covered/a", str(self.sent), congestion_control=zenoh.CongestionControl.BLOCK)
            self.sent += 1


def test_reloads_lose_and_double_nothing(stack, tmp_path):
    """Every sample arrives once, whichever specs decide upon it, and the counts add up."""
    file = tmp_path / "specs.toml"
    file.write_text(KINDS[0])
    endpoint, mesh = free_endpoint(), free_endpoint()
    config = Config(
        robot="r1",
        app=AppConfig(listen=(endpoint,)),
        mesh=MeshConfig(listen=(mesh,), scouting=False),
        specs=SpecsConfig(path=file),
        planner=PlannerConfig(iterations=50, backlog=256),
    )
    daemon = Daemon(config, read_specs(file))
    daemon.start()
    stack.callback(daemon.stop)
    remote = Heard(closing(stack, plain_session("peer", connect=(mesh,))), "covered/a")
    app = closing(stack, plain_session("client", connect=(endpoint,)))
    matching = app.declare_publisher("covered/a")
    wait_until(lambda: matching.matching_status.matching, what="the subscriber")
    publisher = Publisher(app)
    try:
        for number in range(RELOADS):
            file.write_text(KINDS[number % len(KINDS)] + f"# {number}\n")
            assert daemon.reloading.reload(f"reload {number}") == ()
            if number < len(KINDS):
                came = counts_of(app)["in"]
                wait_until(lambda came=came: counts_of(app)["in"] > came, what="a sample that each kind decides on")
    finally:
        publisher.stop()
    assert daemon.reloading.describe()["done"] == RELOADS
    wait_until(lambda: len(remote.samples) >= publisher.sent, what="every sample")
    assert sorted(map(int, remote.payloads)) == list(range(publisher.sent))
    wait_until(lambda: counts_of(app)["in"] == publisher.sent, what="the counts")
    counts = counts_of(app)
    assert counts["conserved"]
    assert counts["forwarded"] == publisher.sent
    assert counts["by_reason"]["forwarded"] > 0
    assert counts["by_reason"]["passed:no-spec"] > 0


def counts_of(app):
    (answer,) = answers(app, keys.status("r1"))
    return json.loads(answer)["counts"]
